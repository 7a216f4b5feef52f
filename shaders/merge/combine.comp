// Reads the forward estimate of a frame, which includes the frame itself, the backward prediction, which does
// not, and the patch sums of combine_statistics; writes their combination with inverse variances as weights:
// the fixed-interval smoother in its two-filter form (Fraser and Potter 1969).
// The variances are those of the patch without the pixel, divided by the pixel's own effective sample counts:
// a Monte Carlo pixel's variance grows with its value, and weights derived from that value would darken the
// image. A smoothed pixel's variance is that of its window, while its bias is its own. There the weights use
// the geometric mean of the pixel's and the patch's variance.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/combine.glsl"
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"
#include "shared/limits.h"

layout(constant_id = 0) const int radius = 3;
layout(constant_id = 1) const int smoothed = 0;       // 1: estimates are merged from smoothed frames
layout(constant_id = 2) const int writes_weight = 0;  // 1: writes `weight_backward`, for AOVs that are combined with it

/// A pixel's own variance counts as at least this share of its patch's: one black window must not decide
/// alone.
const float kLeastOfPatch = 0.01;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer forward_color;
layout(set = 0, binding = 1) uniform samplerBuffer forward_stats;
layout(set = 0, binding = 2) uniform samplerBuffer backward_color;
layout(set = 0, binding = 3) uniform samplerBuffer backward_stats;
layout(set = 0, binding = 4) uniform samplerBuffer statistics;
layout(set = 0, binding = 5) uniform samplerBuffer statistics_sums;
layout(std430, set = 0, binding = 6) writeonly buffer ColorBuffer { vec4 data[]; } color;
layout(std430, set = 0, binding = 7) writeonly buffer StatsBuffer { vec2 data[]; } stats;
layout(std430, set = 0, binding = 8) writeonly buffer WeightBuffer { float data[]; } weight_backward;

#include "lib/patch_sum.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec4 sum = patch_without_pixel(statistics, statistics_sums, at);
  const vec2 stats_f = texelFetch(forward_stats, index).xy;
  const vec2 stats_b = texelFetch(backward_stats, index).xy;
  const vec4 f = texelFetch(forward_color, index);
  const vec4 b = texelFetch(backward_color, index);
  const bool has_f = stats_f.y > 0.0;
  const bool has_b = stats_b.y > 0.0;
  const float counted = stats_b.y / max(stats_f.y + stats_b.y, 1e-6);
  // An estimate's variance is that of a frame over the sample count. Without neighbours, all frames count
  // alike.
  vec2 of_frame = sum.xy / max(sum.z, 1.0);
  if (smoothed != 0) of_frame = sqrt(of_frame) * sqrt(max(texelFetch(statistics, index).xy, kLeastOfPatch * of_frame));
  float weight = sum.z >= 1.0 ? gain(of_frame.y / max(stats_b.y, 1e-6), of_frame.x / max(stats_f.y, 1e-6), 0.0) : counted;
  // Both are exact: take the forward estimate, which includes the frame.
  if (sum.z >= 1.0 && of_frame.x + of_frame.y <= 0.0) weight = 0.0;
  if (!has_f) weight = 1.0;
  if (!has_b) weight = 0.0;

  const float rest = 1.0 - weight;
  const float variance = rest * rest * stats_f.x + weight * weight * stats_b.x;
  const float inverse_count = rest * rest / max(stats_f.y, 1e-6) + weight * weight / max(stats_b.y, 1e-6);
  color.data[index] = combine(f, b, weight);
  stats.data[index] = weight <= 0.0   ? stats_f
                      : weight >= 1.0 ? stats_b
                                      : vec2(min(variance, kLargestVariance), 1.0 / inverse_count);
  if (writes_weight != 0) weight_backward.data[index] = weight;
}
