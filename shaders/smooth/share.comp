// Reads smooth/lost's outputs, their sums over patches, the variance of the frame and the error that the network
// expects; writes (share of the frame that is put back, mean of the patch's relative variances) and the
// variance that then remains. What a patch lost beyond its noise was detail: the share minimises the expected
// squared error of the mix (lib/gain.glsl). The loss must exceed what the variance may be wrong by, and be
// significant by its own spread over the patch: where light is sparse, few pixels rule both the squared
// difference and the variance, and neither tells much. Surfaces and the background have patches of their own,
// since one is often clean where the other is noisy. The pixel itself is left out of its patch, since a share
// derived from the value that it weighs would darken the image. Only a pixel that no noise can explain, such as
// a star, decides for itself.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"
#include "shared/limits.h"

/// What a patch's variance may be wrong by, over the variance: in merged frames of sparse light it is up to a fifth too
/// small, since the weights of frames depend a little on their samples.
const float kUnsure = 0.25;
/// Standard errors by which the mean excess must exceed zero: of even patches, one in 740 does by chance. It then
/// shrinks as James and Stein (1961) have it.
const float kSignificance = 3.0;
/// A difference of more than this many standard deviations of the pixel's and of its patch's noise is not
/// noise.
const float kCertain = 16.0;

layout(constant_id = 0) const int separate = 1;  // as in smooth/lost

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer lost;
layout(set = 0, binding = 1) uniform samplerBuffer lost_sums;
layout(set = 0, binding = 2) uniform samplerBuffer variance;
layout(set = 0, binding = 3) uniform samplerBuffer expected;
layout(set = 0, binding = 4) uniform samplerBuffer albedo_depth;
layout(set = 0, binding = 5) uniform samplerBuffer normal;
layout(set = 0, binding = 6) uniform samplerBuffer lost_background;
layout(set = 0, binding = 7) uniform samplerBuffer lost_background_sums;
layout(std430, set = 0, binding = 8) writeonly buffer ShareBuffer { vec2 data[]; } share;
layout(std430, set = 0, binding = 9) writeonly buffer StatsBuffer { vec2 data[]; } stats;

#include "lib/surface.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const bool background = separate != 0 && !shows_surface(index);
  const vec4 sum = background ? texelFetch(lost_background_sums, index) : texelFetch(lost_sums, index);
  const float count = max(sum.w, 1.0);
  const vec2 noisy = texelFetch(variance, index).xy;
  const vec2 smooth_stats = texelFetch(expected, index).xy;
  const vec3 mean = max(sum.xyz / count, vec3(0.0));
  const float uncertain = kSignificance * kSignificance * mean.y / count;
  const float excess = max(mean.x - kUnsure * mean.z, 0.0);
  const float detail = excess * excess > uncertain ? excess - uncertain / excess : 0.0;
  const vec4 own = background ? texelFetch(lost_background, index) : texelFetch(lost, index);
  const float noise = max(own.z, mean.z);
  const float squared = own.x + own.z;
  const bool certain = squared > kCertain * kCertain * noise;
  const float of_pixel = certain ? squared / (squared + noise) : 0.0;
  const float of_patch = detail > 0.0 ? detail / (detail + mean.z) : 0.0;
  const float put_back = noisy.y > 0.0 ? max(of_pixel, of_patch) : 0.0;
  share.data[index] = vec2(put_back, mean.z);
  const float rest = 1.0 - put_back;
  const float left = rest * rest * smooth_stats.x + put_back * put_back * noisy.x;
  stats.data[index] = vec2(min(left, kLargestVariance), smooth_stats.y);
}
