// Reads smooth/lost's output for a frame and its result, its patch sums, how many frames were merged, and the
// result with the squared error that the network expects; writes (share, noise, 1, that error). Averaging n
// frames leaves an n-th of a frame's variance; an error beyond that is blur, which the frame itself does not
// have. The share is that excess over the squared difference of frame and result. It may be negative: own_share
// averages shares over a patch. The noise is the larger of the patch's variance and its squared difference.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"

layout(constant_id = 0) const int radius = 3;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer lost;
layout(set = 0, binding = 1) uniform samplerBuffer lost_sums;
layout(set = 0, binding = 2) uniform samplerBuffer smoothed;
layout(set = 0, binding = 3) uniform samplerBuffer expected;
layout(set = 0, binding = 4) uniform samplerBuffer exposure;
layout(set = 0, binding = 5) uniform samplerBuffer frames;
layout(std430, set = 0, binding = 6) writeonly buffer BlurBuffer { vec4 data[]; } blur;

#include "lib/patch_row.glsl"

/// Relative squared difference below which frame and result are the same.
const float kLeastNoise = 1e-12;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec4 own = texelFetch(lost, index);
  const vec4 sum = patch_without_pixel(lost, lost_sums, at);
  const vec2 mean = sum.xy / max(sum.z, 1.0);
  const vec4 y = texelFetch(smoothed, index);
  const vec2 of_network = texelFetch(expected, index).xy;
  const float scale = 1.0 / brightness(y.r, y.g, y.b, texelFetch(exposure, 0).x);
  const float error = min(of_network.x * scale * scale, kLargestDifference * kLargestDifference);
  const float blurred = error - own.y / max(texelFetch(frames, index).x, 1.0);
  const float share = clamp(blurred / max(max(mean.x, own.y), kLeastNoise), -1.0, 1.0);
  const bool counts = own.z > 0.0 && of_network.y > 0.0 && sum.z >= 1.0;
  blur.data[index] = counts ? vec4(share, max(max(mean.x, mean.y), kLeastNoise), 1.0, error) : vec4(0.0);
}
