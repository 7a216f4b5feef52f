// Reads the new frame, the warped history and the patch sums of their statistics; writes the merged frame,
// which is the next frame's history. The weight of the new sample minimises the expected squared error
// (Philippi et al., eq. 4); bias^2 is estimated from the patch residuals that noise does not explain.
// The pixel is left out of its own patch: a Monte Carlo sample's variance grows with its value, and weights
// derived from that value would darken the image. A smoothed pixel's variance is that of its window. It
// replaces the patch's variance where it is smaller: sky between leaves. The variance of an unsmoothed pixel
// only limits by how much the patch's may exceed it, which matters beside the disc of the sun.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"
#include "shared/limits.h"

layout(constant_id = 0) const int radius = 3;
layout(constant_id = 1) const int smoothed = 0;  // 1: the new frame is smoothed; its variance is that of a window's mean

/// Standard deviations beyond which a difference is certainly no noise.
const float kCertain = 8.0;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer warped_color;
layout(set = 0, binding = 3) uniform samplerBuffer warped_stats;
layout(set = 0, binding = 4) uniform samplerBuffer exposure;
layout(set = 0, binding = 5) uniform samplerBuffer difference;
layout(set = 0, binding = 6) uniform samplerBuffer noise;
layout(set = 0, binding = 7) uniform samplerBuffer difference_sums;
layout(set = 0, binding = 8) uniform samplerBuffer noise_sums;
layout(std430, set = 0, binding = 9) writeonly buffer MergedColorBuffer { vec4 data[]; } merged_color;
layout(std430, set = 0, binding = 10) writeonly buffer MergedStatsBuffer { vec2 data[]; } merged_stats;
layout(std430, set = 0, binding = 11) writeonly buffer DecisionBuffer { vec4 data[]; } decision;

#include "lib/blend.glsl"
#include "lib/patch_sum.glsl"

/// Relative squared bias of a pixel that is darker than its history by more than any noise explains, such as a single
/// leaf that has come before the sky; its neighbours may all agree with their history. Brighter pixels may be outliers.
float bias_of_dark_pixel(int index, vec4 x, vec4 h) {
  const float difference_squared = texelFetch(difference, index).a;
  const vec2 variances = texelFetch(noise, index).xy;
  const bool darker = luminance(x.r, x.g, x.b) < luminance(h.r, h.g, h.b);
  return darker && difference_squared > kCertain * kCertain * (variances.x + variances.y) ? difference_squared : 0.0;
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec4 difference_sum = patch_without_pixel(difference, difference_sums, at);
  const vec4 noise_sum = patch_without_pixel(noise, noise_sums, at);
  const float count = noise_sum.z;
  float alpha = 1.0;
  float bias_squared = 0.0;
  float rejected = 0.0;
  if (count >= 1.0) {
    const float variance_of_patch = noise_sum.x / count;
    const vec4 x = texelFetch(color, index);
    const vec4 h = texelFetch(warped_color, index);
    const float exposed_to = texelFetch(exposure, 0).x;
    const float scale = brightness(h.r, h.g, h.b, exposed_to);
    const float light = max(abs(luminance(x.r, x.g, x.b)), 1.0 / exposed_to) / scale;
    const float own_variance = texelFetch(noise, index).x;
    const float variance_new = smoothed != 0 ? min(variance_of_patch, own_variance)
                                             : borrowed_variance(variance_of_patch, own_variance, light);
    const float variance_history = noise_sum.y / count;
    const vec3 mean = difference_sum.rgb / count;
    const float of_patch = patch_bias(dot(mean, mean) / 3.0, difference_sum.a / count, noise_sum.w / count, count, smoothed != 0);
    const float relative_bias = max(of_patch, smoothed != 0 ? bias_of_dark_pixel(index, x, h) : 0.0);
    alpha = max(gain(variance_new, variance_history, relative_bias), 1.0 / kMostFrames);
    // The share by which the bias lowers the history's weight: 1 - (1 - alpha) / (1 - alpha without bias).
    rejected = relative_bias > 0.0 ? relative_bias / (variance_new + variance_history + relative_bias) : 0.0;
    bias_squared = min(relative_bias * scale * scale, kLargestVariance);
  }
  blend(index, alpha, bias_squared, rejected, bias_squared);
}
