// Reads smooth/blur's output, its patch sums, smooth/lost's output, the variance of the mean of `frames`
// frames and the result's statistics; writes the frame's share of the result, and the statistics of the mix.
// The share is the mean over the patch without the pixel: shares that follow from the value that they weigh
// darken the image. It is as much less as the frame itself is a part of what was merged. Limits follow from
// the pixel: the share that it would have if all of the expected error were blur, and less for outliers, whose
// light is restored with that of others (filter/smooth/energy.h).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"

/// Standard deviations of noise from which a pixel is an outlier.
const float kOutlier = 2.0;

layout(constant_id = 0) const int radius = 3;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer blur;
layout(set = 0, binding = 1) uniform samplerBuffer blur_sums;
layout(set = 0, binding = 2) uniform samplerBuffer lost;
layout(set = 0, binding = 3) uniform samplerBuffer variance;
layout(set = 0, binding = 4) uniform samplerBuffer stats;
layout(set = 0, binding = 5) uniform samplerBuffer frames;
layout(std430, set = 0, binding = 6) writeonly buffer ShareBuffer { float data[]; } share;
layout(std430, set = 0, binding = 7) writeonly buffer MixedStatsBuffer { vec2 data[]; } mixed_stats;

#include "lib/patch_row.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec4 sum = patch_without_pixel(blur, blur_sums, at);
  const vec4 own = texelFetch(blur, index);
  const vec2 difference_and_noise = texelFetch(lost, index).xy;
  const float count = texelFetch(frames, index).x;
  const float error_and_noise = own.w + difference_and_noise.y;
  float of_frame = 0.0;
  if (own.z > 0.0 && sum.x > 0.0 && error_and_noise > 0.0) {
    const float explained = kOutlier * kOutlier * min(error_and_noise, own.y);
    of_frame = (1.0 - 1.0 / max(count, 1.0)) * min(sum.x / sum.z, own.w / error_and_noise) *
               (explained / max(explained, difference_and_noise.x));
  }
  share.data[index] = of_frame;
  const vec2 before = texelFetch(stats, index).xy;
  const float rest = 1.0 - of_frame;
  const float noise = texelFetch(variance, index).x * count;
  const float left = rest * rest * before.x + of_frame * of_frame * noise;
  mixed_stats.data[index] = vec2(min(left, kLargestVariance), before.y);
}
