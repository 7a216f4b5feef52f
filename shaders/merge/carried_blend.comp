// Reads a carried image (an additive AOV or a noisy layer) of the new frame and of the warped history, and
// the merge's decision for the beauty; writes the image's new history, blended as in lib/blend.glsl with the
// beauty's weight.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/dispatch_size.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer warped_color;
layout(set = 0, binding = 2) uniform samplerBuffer warped_stats;
layout(set = 0, binding = 3) uniform samplerBuffer decision;
layout(std430, set = 0, binding = 4) writeonly buffer MergedBuffer { vec4 data[]; } merged;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec4 x = texelFetch(color, index);
  const vec4 h = texelFetch(warped_color, index);
  const float alpha = texelFetch(decision, index).z;
  const bool has_history = texelFetch(warped_stats, index).y > 0.0;
  merged.data[index] = has_history && alpha < 1.0 ? h + alpha * (x - h) : x;
}
