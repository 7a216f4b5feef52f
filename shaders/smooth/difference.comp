// Reads a frame, an estimate of it with (expected squared error, count), and a variance that is divided by
// the count: for a smoothed merged frame that of the mean, with a count of 1; else that of one frame, with
// the number of frames merged.
// Writes what own_share averages over patches: (squared difference, expected error, variance of the mean, 1),
// relative to the estimate's brightness; zeros for a pixel that is not finite. A pixel's variance is at least
// a share of the mean of the patch around it (smooth/share), if given: where light is sparse, most pixels got
// none and seem to have no noise.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"

/// Of the patch's mean variance that a pixel has at least; and what that is at most, beside fireflies.
const float kLeastOfPatch = 0.1;
const float kLargestLeast = 0.05;

layout(constant_id = 0) const int has_detail = 1;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer frame;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer estimate;
layout(set = 0, binding = 3) uniform samplerBuffer estimate_stats;
layout(set = 0, binding = 4) uniform samplerBuffer exposure;
layout(set = 0, binding = 5) uniform samplerBuffer detail;
layout(std430, set = 0, binding = 6) writeonly buffer DifferenceBuffer { vec4 data[]; } difference;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec3 y = texelFetch(estimate, index).rgb;
  const vec2 noise = texelFetch(variance, index).xy;
  const float scale = 1.0 / brightness(y.r, y.g, y.b, texelFetch(exposure, 0).x);
  const vec3 d = clamp((texelFetch(frame, index).rgb - y) * scale, -kLargestDifference, kLargestDifference);
  const vec2 error = texelFetch(estimate_stats, index).xy;
  const vec2 variances = max(vec2(error.x, noise.x / max(error.y, 1.0)), 0.0);
  const vec2 deviations = min(sqrt(variances) * scale, kLargestDifference);
  const float least = has_detail != 0 ? min(kLeastOfPatch * texelFetch(detail, index).y, kLargestLeast) : 0.0;
  const vec2 relative = max(deviations * deviations, vec2(0.0, least));
  difference.data[index] = noise.y > 0.0 ? vec4(dot(d, d) / 3.0, relative, 1.0) : vec4(0.0);
}
