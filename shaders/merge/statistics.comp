// Reads the new frame, its variance and the warped history; writes what variance_gain's patch sums add up:
// (difference r, g, b; squared difference) and (variance of the new frame, variance of the history, 1,
// squared difference that is expected of both).
// All are relative to the history's brightness, so that the brightest pixel does not dominate its patch, and
// limited so that no square or sum leaves the range of floats. Pixels without history or with a sample that
// is not finite get zeros.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"

// What of a difference is expected, as filter/merge/statistics.cpp names it. 0: nothing, since most of a smoothed
// frame's error is blur, which its history has alike; 1: the noise of both; 2: the errors of both, as far as the noisy
// frame's variance tells that they are not blur.
layout(constant_id = 0) const int expectation = 1;
layout(constant_id = 1) const int noisy_channel = 0;  // that holds the noisy frame's variance

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer warped_color;
layout(set = 0, binding = 3) uniform samplerBuffer warped_stats;
layout(set = 0, binding = 4) uniform samplerBuffer exposure;
layout(set = 0, binding = 5) uniform samplerBuffer noisy;
layout(std430, set = 0, binding = 6) writeonly buffer DifferenceBuffer { vec4 data[]; } difference;
layout(std430, set = 0, binding = 7) writeonly buffer NoiseBuffer { vec4 data[]; } noise;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec2 sample_stats = texelFetch(variance, index).xy;
  const vec2 stats = texelFetch(warped_stats, index).xy;
  const bool counts = sample_stats.y > 0.0 && stats.y > 0.0;
  const vec4 h = texelFetch(warped_color, index);
  const float scale = 1.0 / brightness(h.r, h.g, h.b, texelFetch(exposure, 0).x);
  const vec3 d = clamp((texelFetch(color, index).rgb - h.rgb) * scale, -kLargestDifference, kLargestDifference);
  const vec2 variances = min(vec2(sample_stats.x, stats.x) * scale * scale, kLargestDifference * kLargestDifference);
  float expected = expectation == 0 ? 0.0 : variances.x + variances.y;
  if (expectation == 2) {
    const float noisy_variance = texelFetch(noisy, index)[noisy_channel] * scale * scale;
    expected *= unshared_part(variances.x, min(noisy_variance, kLargestDifference * kLargestDifference));
  }
  difference.data[index] = counts ? vec4(d, dot(d, d) / 3.0) : vec4(0.0);
  noise.data[index] = counts ? vec4(variances, 1.0, expected) : vec4(0.0);
}
