// Reads a frame or an additive AOV, its smoothed result and the share that is put back; writes both mixed by
// that share.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/dispatch_size.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer smoothed;
layout(set = 0, binding = 2) uniform samplerBuffer share;
layout(std430, set = 0, binding = 3) writeonly buffer RestoredBuffer { vec4 data[]; } restored;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec4 y = texelFetch(smoothed, index);
  restored.data[index] = y + texelFetch(share, index).x * (texelFetch(color, index) - y);
}
