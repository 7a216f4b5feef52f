// Reads a frame and its albedo; writes what noise_share sums over patches: (squared second difference along both axes
// of taps at distance 1, of taps at distance 2, 1, 0), of the radiance without albedo, relative to its brightness.
// Independent noise makes both equal; detail that spans pixels makes the second several times the first. The first is
// the mean over the four diagonal neighbours, so that both depend on the same 5x5 pixels and a firefly changes both.
// Zeros for pixels that are not finite and beside those at the end of the range of floats.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"
#include "lib/reflectance.glsl"

layout(constant_id = 0) const int has_albedo = 1;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer valid;
layout(set = 0, binding = 2) uniform samplerBuffer albedo_depth;
layout(set = 0, binding = 3) uniform samplerBuffer exposure;
layout(std430, set = 0, binding = 4) writeonly buffer ScalesBuffer { vec4 data[]; } scales;

const int kSide = 5;
const int kTaps = kSide * kSide;

/// The squared second difference, mean of the channels, around `middle` of taps so many pixels apart.
float squared_difference(vec3 values[kTaps], int middle, int distance, float scale) {
  vec3 sum = vec3(0.0);
  [[unroll]] for (int j = -1; j <= 1; ++j) {
    [[unroll]] for (int i = -1; i <= 1; ++i) {
      sum += (i == 0 ? -2.0 : 1.0) * (j == 0 ? -2.0 : 1.0) * values[middle + distance * (j * kSide + i)];
    }
  }
  sum = clamp(sum * scale, -kLargestDifference, kLargestDifference);
  return dot(sum, sum) / 3.0;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  vec3 values[kTaps];
  vec3 mean = vec3(0.0);
  [[unroll]] for (int t = 0; t < kTaps; ++t) {
    const ivec2 tap = clamp(at + ivec2(t % kSide, t / kSide) - kSide / 2, ivec2(0), size - 1);
    const int from = tap.y * size.x + tap.x;
    values[t] = texelFetch(color, from).rgb;
    if (has_albedo != 0) values[t] /= divisor_of(texelFetch(albedo_depth, from).rgb);
    mean += values[t] / float(kTaps);
  }
  const float scale = 1.0 / brightness(mean.r, mean.g, mean.b, texelFetch(exposure, 0).x);
  const int middle = kTaps / 2;
  float near = 0.0;
  [[unroll]] for (int diagonal = 0; diagonal < 4; ++diagonal) {
    const int beside = diagonal % 2 * 2 - 1 + (diagonal / 2 * 2 - 1) * kSide;
    near += squared_difference(values, middle + beside, 1, scale) / 4.0;
  }
  const float far = squared_difference(values, middle, 2, scale);
  const bool counts = texelFetch(valid, index).y > 0.0 && !isnan(near + far);
  scales.data[index] = counts ? vec4(near, far, 1.0, 0.0) : vec4(0.0);
}
