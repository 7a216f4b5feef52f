// Reads a frame that came without variance and its features; writes an estimate of each pixel's variance. A
// first-order fit over 3x3 pixels predicts the radiance without albedo from albedo, normal, depth and
// position. The estimate is the pixel's squared residual over the share of independent noise that such a
// residual keeps.
// So textures, surface edges and gradients of light do not count as noise; only detail that no feature
// explains, such as borders of shadows and of reflections, raises the estimate. The square of a single pixel
// is noisy itself, but unbiased, and fireflies appear in it as they do in half-buffers.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"
#include "lib/reflectance.glsl"
#include "shared/limits.h"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer valid;
layout(set = 0, binding = 2) uniform samplerBuffer albedo_depth;
layout(set = 0, binding = 3) uniform samplerBuffer normal;
layout(std430, set = 0, binding = 4) writeonly buffer VarianceBuffer { vec2 data[]; } variance;

const int kTaps = 9;
const int kFeatures = 9;  // albedo, depth, normal, position
const float kRidge = 1e-2;  // share of the sum of weights: flat or noisy features explain nothing
const float kWeightRadius = 0.3;  // difference of features at which a pixel counts for exp(-1/2)
const float kLeastWeight = 0.02;  // so that a pixel unlike all of its neighbours does not explain itself

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec4 albedo_depth_here = texelFetch(albedo_depth, index);
  const vec3 normal_here = texelFetch(normal, index).xyz;

  float feature[kTaps][kFeatures];
  float weight[kTaps];
  vec3 irradiance[kTaps];
  [[unroll]] for (int t = 0; t < kTaps; ++t) {
    const ivec2 shift = ivec2(t % 3 - 1, t / 3 - 1);
    const ivec2 tap = at + shift;
    const bool inside = tap.x >= 0 && tap.y >= 0 && tap.x < size.x && tap.y < size.y;
    const int from = inside ? tap.y * size.x + tap.x : index;
    const vec4 albedo_depth_there = texelFetch(albedo_depth, from);
    const vec4 a = albedo_depth_there - albedo_depth_here;
    const vec3 n = texelFetch(normal, from).xyz - normal_here;
    const float alike = exp(-(dot(a, a) + dot(n, n)) / (2.0 * kWeightRadius * kWeightRadius));
    weight[t] = inside ? max(alike, kLeastWeight) * texelFetch(valid, from).y : 0.0;
    irradiance[t] = texelFetch(color, from).rgb / divisor_of(albedo_depth_there.rgb);
    [[unroll]] for (int f = 0; f < 4; ++f) feature[t][f] = a[f];
    [[unroll]] for (int f = 0; f < 3; ++f) feature[t][4 + f] = n[f];
    [[unroll]] for (int f = 0; f < 2; ++f) feature[t][7 + f] = 0.5 * float(shift[f]);
  }

  // Normal equations, features first and the constant last. The fit's value at the pixel is the constant. A
  // tap's share in it is the tap's weight times (slope . feature + constant), where slope and constant solve
  // the equations for the constant's unit vector.
  float m[kFeatures + 1][kFeatures + 1];
  float sum = 0.0;
  [[unroll]] for (int t = 0; t < kTaps; ++t) sum += weight[t];
  [[unroll]] for (int r = 0; r <= kFeatures; ++r) {
    [[unroll]] for (int s = 0; s <= kFeatures; ++s) {
      if (s < r) continue;
      float moment = r == s && r < kFeatures ? kRidge * sum + 1e-20 : 0.0;
      [[unroll]] for (int t = 0; t < kTaps; ++t) {
        moment += weight[t] * (r < kFeatures ? feature[t][min(r, kFeatures - 1)] : 1.0) *
                  (s < kFeatures ? feature[t][min(s, kFeatures - 1)] : 1.0);
      }
      m[r][s] = moment;
    }
  }
  [[unroll]] for (int r = 0; r < kFeatures; ++r) {
    [[unroll]] for (int t = 0; t <= kFeatures; ++t) {
      if (t <= r) continue;
      const float share = m[r][t] / m[r][r];
      [[unroll]] for (int s = 0; s <= kFeatures; ++s) {
        if (s >= t) m[t][s] -= share * m[r][s];
      }
    }
  }
  const float constant = 1.0 / max(m[kFeatures][kFeatures], 1e-6);
  float slope[kFeatures];
  [[unroll]] for (int r = kFeatures - 1; r >= 0; --r) {
    slope[r] = -m[r][kFeatures] * constant;
    [[unroll]] for (int s = 0; s < kFeatures; ++s) {
      if (s > r) slope[r] -= m[r][s] * slope[s];
    }
    slope[r] /= m[r][r];
  }

  vec3 remainder = vec3(0.0);
  float noise_left = 0.0;  // the residual's variance if each pixel has unit variance
  [[unroll]] for (int t = 0; t < kTaps; ++t) {
    float part = constant;
    [[unroll]] for (int f = 0; f < kFeatures; ++f) part += slope[f] * feature[t][f];
    part = weight[t] * part - (t == kTaps / 2 ? 1.0 : 0.0);
    remainder += part * irradiance[t];
    noise_left += part * part;
  }
  remainder *= divisor_of(albedo_depth_here.rgb);
  const float estimate = min(dot(remainder, remainder) / (3.0 * max(noise_left, 1e-4)), kLargestVariance);
  variance.data[index] = vec2(estimate, texelFetch(valid, index).y);
}
