// Reads the radiance without albedo, the features and the window's weights; writes the value at the pixel of the plane that
// fits the window best, first order in the features (Bitterli et al. 2016, "Nonlinearly weighted first-order regression
// for denoising Monte Carlo renderings", eq. 4), with the albedo again, and (variance left, 1). The slopes are shrunk by a
// ridge, so that features that are flat or mere noise explain nothing. Pixels of other surfaces count less. The value is
// mixed with the window's mean, by one share for all channels, until it lies within the window's range: given weights and
// share it is linear in the radiance. `kernel` has what additive AOVs are then smoothed alike by (additive/smooth), in three
// planes: two of lib/smoothing_kernel.glsl, and by what the value differs from that sum, which is rounding, but may be a
// ten-thousandth of a dark pixel among bright ones.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/gain.glsl"
#include "lib/resample.glsl"
#include "shared/smooth_params.h"

layout(constant_id = 0) const int radius = 5;
layout(constant_id = 1) const int writes_kernel = 0;  // 1: `kernel` is an image

layout(local_size_x = 8, local_size_y = 4) in;
layout(push_constant) uniform Params { SmoothParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer irradiance;
layout(set = 0, binding = 3) uniform samplerBuffer guide;
layout(set = 0, binding = 4) uniform samplerBuffer albedo_depth;
layout(set = 0, binding = 5) uniform samplerBuffer normal;
layout(set = 0, binding = 6) uniform samplerBuffer exposure;
layout(set = 0, binding = 7) uniform usamplerBuffer weights;
layout(std430, set = 0, binding = 8) writeonly buffer SmoothedBuffer { vec4 data[]; } smoothed;
layout(std430, set = 0, binding = 9) writeonly buffer StatsBuffer { vec2 data[]; } stats;
layout(std430, set = 0, binding = 10) writeonly buffer KernelBuffer { vec4 data[]; } kernel;

#include "lib/smoothing_kernel.glsl"

const int kFeatures = 7;
const float kRidge = 3e-4;  // of the sum of weights

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  const int shifts = (2 * radius + 1) * (2 * radius + 1);
  const int planes = (shifts + kShiftsPerPlane - 1) / kShiftsPerPlane;
  const vec4 albedo_depth_here = texelFetch(albedo_depth, index);
  const vec3 normal_here = texelFetch(normal, index).xyz;
  const vec3 falloff = surface_falloff(at);

  // Moments: the features are a (albedo and depth) and n (normal), the values c.
  float sum = 0.0;
  vec3 sum_c = vec3(0.0);
  vec4 sum_a = vec4(0.0);
  vec3 sum_n = vec3(0.0);
  mat4 a_a = mat4(0.0);
  mat3x4 a_n = mat3x4(0.0);
  mat3 n_n = mat3(0.0);
  mat3x4 a_c = mat3x4(0.0);
  mat3 n_c = mat3(0.0);
  float sum_noise = 0.0;
  vec3 lowest = vec3(kLargestDifference);
  vec3 highest = vec3(-kLargestDifference);
  for (int plane = 0; plane < planes; ++plane) {
    const uint packed = texelFetch(weights, (plane * p.height + at.y) * p.width + at.x).x;
    [[unroll]] for (int i = 0; i < kShiftsPerPlane; ++i) {
      const ivec2 q = clamp(at + window_shift(plane * kShiftsPerPlane + i, radius), ivec2(0), ivec2(p.width, p.height) - 1);
      const int tap = q.y * p.width + q.x;
      const vec4 value = texelFetch(irradiance, tap);
      const vec4 a = texelFetch(albedo_depth, tap) - albedo_depth_here;
      const vec3 n = texelFetch(normal, tap).xyz - normal_here;
      const float w = float((packed >> (8 * i)) & 255u) / 255.0 * value.a * surface_weight(a, n, falloff);
      const vec4 wa = w * a;
      const vec3 wn = w * n;
      sum += w;
      sum_c += w * value.rgb;
      sum_a += wa;
      sum_n += wn;
      a_a += outerProduct(wa, a);
      a_n += outerProduct(wa, n);
      n_n += outerProduct(wn, n);
      a_c += outerProduct(wa, value.rgb);
      n_c += outerProduct(wn, value.rgb);
      sum_noise += w * texelFetch(guide, tap).y;
      lowest = w > 0.0 ? min(lowest, value.rgb) : lowest;
      highest = w > 0.0 ? max(highest, value.rgb) : highest;
    }
  }

  // Normal equations, the features first and the constant last: eliminating the features leaves the value at the pixel.
  float m[kFeatures + 1][kFeatures + 4];
  [[unroll]] for (int r = 0; r < 4; ++r) {
    [[unroll]] for (int s = 0; s < 4; ++s) m[r][s] = a_a[s][r];
    [[unroll]] for (int s = 0; s < 3; ++s) {
      m[r][4 + s] = a_n[s][r];
      m[4 + s][r] = a_n[s][r];
      m[r][kFeatures + 1 + s] = a_c[s][r];
    }
    m[r][kFeatures] = sum_a[r];
    m[kFeatures][r] = sum_a[r];
  }
  [[unroll]] for (int r = 0; r < 3; ++r) {
    [[unroll]] for (int s = 0; s < 3; ++s) {
      m[4 + r][4 + s] = n_n[s][r];
      m[4 + r][kFeatures + 1 + s] = n_c[s][r];
    }
    m[4 + r][kFeatures] = sum_n[r];
    m[kFeatures][4 + r] = sum_n[r];
    m[kFeatures][kFeatures + 1 + r] = sum_c[r];
  }
  m[kFeatures][kFeatures] = sum;
  [[unroll]] for (int r = 0; r < kFeatures; ++r) {
    m[r][r] += kRidge * sum + 1e-20;
    [[unroll]] for (int t = r + 1; t <= kFeatures; ++t) {
      const float share = m[t][r] / m[r][r];
      [[unroll]] for (int s = r + 1; s < kFeatures + 4; ++s) m[t][s] -= share * m[r][s];
    }
  }
  const float support = max(m[kFeatures][kFeatures], 1e-6);
  const vec3 fitted = vec3(m[kFeatures][kFeatures + 1], m[kFeatures][kFeatures + 2], m[kFeatures][kFeatures + 3]) / support;
  const vec3 mean = sum_c / max(sum, 1e-6);
  float share = 1.0;
  [[unroll]] for (int c = 0; c < 3; ++c) share = min(share, sharp_share(fitted[c], mean[c], lowest[c], highest[c]));
  const vec3 value = clamp(mean + share * (fitted - mean), lowest, highest);

  const vec4 own = texelFetch(color, index);
  const vec2 own_stats = texelFetch(variance, index).xy;
  const vec3 scale = divisor_of(albedo_depth_here.rgb) / texelFetch(exposure, 0).x;
  const bool known = own_stats.y > 0.0 && sum > 0.0;
  smoothed.data[index] = known ? vec4(value * scale, own.a) : own;
  // With weights near 0 or 1 the sum of their squares in the fit is the inverse of the support; those of surfaces lie between
  // and overstate what is left by up to two fifths.
  const float left = min(sum_noise / max(sum, 1e-6) / support * variance_divisor_of(scale), kLargestVariance);
  stats.data[index] = known ? vec2(left, 1.0) : vec2(own_stats.x, own_stats.y);

  if (writes_kernel != 0) {
    // The weights' slopes: what is left of the triangular system, solved for the features' sums.
    float slope[kFeatures];
    [[unroll]] for (int r = kFeatures - 1; r >= 0; --r) {
      slope[r] = m[r][kFeatures];
      [[unroll]] for (int s = r + 1; s < kFeatures; ++s) slope[r] -= m[r][s] * slope[s];
      slope[r] /= m[r][r];
    }
    const float of_fit = share / support;
    const float constant = of_fit + (1.0 - share) / max(sum, 1e-6);
    const vec3 of_normal = of_fit * vec3(slope[4], slope[5], slope[6]);
    const vec4 k = known ? vec4(constant, of_normal) : vec4(0.0);
    const vec4 of_albedo_depth = of_fit * vec4(slope[0], slope[1], slope[2], slope[3]);
    const vec3 by_kernel = apply_smoothing_kernel(at, radius, k, of_albedo_depth);
    vec3 ratio = value * scale / by_kernel;
    [[unroll]] for (int c = 0; c < 3; ++c) ratio[c] = abs(ratio[c] - 1.0) < 0.01 ? ratio[c] : 1.0;
    const int pixels = p.width * p.height;
    kernel.data[index] = k;
    kernel.data[pixels + index] = of_albedo_depth;
    kernel.data[2 * pixels + index] = vec4(ratio, 0.0);
  }
}
