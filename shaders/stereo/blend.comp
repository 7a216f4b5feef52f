// Reads an eye's estimate, the other eye's warped to it, and the patch sums of their statistics (merge/
// statistics); writes their blend. The weight of the own estimate minimises the expected squared error
// (Philippi et al., eq. 4), with bias^2 from the patch residuals that noise does not explain, as in
// merge/variance_gain: the pixel is left out of its own patch.
// Differs from the paper (eq. 10, 11), which takes variance and squared difference from 3x3 pixels: detail
// counts as noise there.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"
#include "lib/stereo.glsl"
#include "shared/limits.h"

layout(constant_id = 0) const int radius = 3;
layout(constant_id = 1) const int smoothed = 0;       // 1: the estimates are of smoothed frames

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer own_color;
layout(set = 0, binding = 1) uniform samplerBuffer own_stats;
layout(set = 0, binding = 2) uniform samplerBuffer warped_color;
layout(set = 0, binding = 3) uniform samplerBuffer warped_stats;
layout(set = 0, binding = 4) uniform samplerBuffer difference;
layout(set = 0, binding = 5) uniform samplerBuffer noise;
layout(set = 0, binding = 6) uniform samplerBuffer difference_sums;
layout(set = 0, binding = 7) uniform samplerBuffer noise_sums;
layout(set = 0, binding = 8) uniform samplerBuffer exposure;
layout(std430, set = 0, binding = 9) writeonly buffer ColorBuffer { vec4 data[]; } color;
layout(std430, set = 0, binding = 10) writeonly buffer StatsBuffer { vec2 data[]; } stats;
layout(std430, set = 0, binding = 11) writeonly buffer WeightBuffer { float data[]; } weight_other;

#include "lib/patch_sum.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec4 difference_sum = patch_without_pixel(difference, difference_sums, at);
  const vec4 noise_sum = patch_without_pixel(noise, noise_sums, at);
  const vec4 own = texelFetch(own_color, index);
  const vec4 other = texelFetch(warped_color, index);
  const vec2 stats_own = texelFetch(own_stats, index).xy;
  const vec2 stats_other = texelFetch(warped_stats, index).xy;
  const float count = noise_sum.z;
  float alpha = 1.0;
  float bias_squared = 0.0;
  if (count >= 1.0) {
    const float variance_own = noise_sum.x / count;
    const float variance_other = noise_sum.y / count;
    const vec3 mean = difference_sum.rgb / count;
    const float relative_bias = patch_bias(dot(mean, mean) / 3.0, difference_sum.a / count, noise_sum.w / count, count, smoothed != 0);
    alpha = gain(variance_own, variance_other, relative_bias);
    const float bright = brightness(other.r, other.g, other.b, texelFetch(exposure, 0).x);
    bias_squared = min(relative_bias * bright * bright, kLargestVariance);
  }
  if (!(stats_other.y > 0.0)) alpha = 1.0;
  if (!(stats_own.y > 0.0) && stats_other.y > 0.0) alpha = 0.0;
  const float rest = 1.0 - alpha;
  const float variance = alpha * alpha * stats_own.x + rest * rest * (stats_other.x + bias_squared);
  // Selected at 0 and 1, where the other estimate may hold anything.
  color.data[index] = alpha >= 1.0 ? own : alpha <= 0.0 ? other : own + rest * (other - own);
  stats.data[index] = alpha >= 1.0   ? stats_own
                      : alpha <= 0.0 ? stats_other
                                     : vec2(min(variance, kLargestVariance), count_of_both(stats_own.y, stats_other.y, alpha));
  weight_other.data[index] = rest;
}
