// Reads two estimates of a frame; writes the per-pixel statistics from which `combine` makes its weights:
// (variance per frame of the first, of the second, 1, unused), relative to their brightness. The variance per frame
// is the variance times the effective sample count, so that a patch may average pixels with histories of
// different lengths. Pixels that one of the estimates knows nothing of get zeros.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer forward_color;
layout(set = 0, binding = 1) uniform samplerBuffer forward_stats;
layout(set = 0, binding = 2) uniform samplerBuffer backward_color;
layout(set = 0, binding = 3) uniform samplerBuffer backward_stats;
layout(set = 0, binding = 4) uniform samplerBuffer exposure;
layout(std430, set = 0, binding = 5) writeonly buffer StatisticsBuffer { vec4 data[]; } statistics;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec2 stats_f = texelFetch(forward_stats, index).xy;
  const vec2 stats_b = texelFetch(backward_stats, index).xy;
  const vec3 f = texelFetch(forward_color, index).rgb;
  const vec3 b = texelFetch(backward_color, index).rgb;
  const vec3 both = 0.5 * f + 0.5 * b;
  const float scale = 1.0 / brightness(both.r, both.g, both.b, texelFetch(exposure, 0).x);
  const vec2 variances = min(vec2(stats_f.x, stats_b.x) * scale * scale, kLargestDifference * kLargestDifference);
  const bool counts = stats_f.y > 0.0 && stats_b.y > 0.0;
  statistics.data[index] = counts ? vec4(variances * vec2(stats_f.y, stats_b.y), 1.0, 0.0) : vec4(0.0);
}
