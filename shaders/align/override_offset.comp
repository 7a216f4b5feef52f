// Reads offsets and known motion, both at full resolution; writes the motion where it is known, else the offset.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/dispatch_size.glsl"
#include "lib/motion.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer found;
layout(set = 0, binding = 1) uniform samplerBuffer motion;
layout(std430, set = 0, binding = 2) writeonly buffer OffsetBuffer { vec2 data[]; } offset;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int i = at.y * size.x + at.x;
  const vec2 m = texelFetch(motion, i).xy;
  offset.data[i] = is_known_motion(m.x, m.y) ? m : texelFetch(found, i).xy;
}
