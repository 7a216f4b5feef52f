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

layout(constant_id = 0) const int knows_noisy = 0;  // 1: the frame is smoothed, its noisy frame's variance known

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer warped_color;
layout(set = 0, binding = 3) uniform samplerBuffer warped_stats;
layout(set = 0, binding = 4) uniform samplerBuffer exposure;
layout(set = 0, binding = 5) uniform samplerBuffer noisy_variance;
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
  float expected = variances.x + variances.y;
  if (knows_noisy != 0) {
    const float noisy = texelFetch(noisy_variance, index).x * scale * scale;
    expected *= unshared_part(variances.x, min(noisy, kLargestDifference * kLargestDifference));
  }
  difference.data[index] = counts ? vec4(d, dot(d, d) / 3.0) : vec4(0.0);
  noise.data[index] = counts ? vec4(variances, 1.0, expected) : vec4(0.0);
}
