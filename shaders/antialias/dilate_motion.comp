// Reads motion and depth; writes for each pixel the motion of the closest of its 3x3 pixels, so that the
// pixels of an antialiased edge follow the surface in front (survey of Yang et al. 2020, section 3.2).
// Unknown motion stays unknown unless that surface's is known. Without depth, pixels keep their own motion.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"

layout(constant_id = 0) const int has_depth = 1;

/// Unknown motion is written as this, which is unknown too and can be rounded.
const float kFar = 1e6;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer motion;
layout(set = 0, binding = 1) uniform samplerBuffer depth;
layout(std430, set = 0, binding = 2) writeonly buffer DilatedBuffer { vec2 data[]; } dilated;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  int closest = index;
  if (has_depth != 0) {
    float least = texelFetch(depth, index).x;
    [[unroll]] for (int k = 0; k < 9; ++k) {
      const ivec2 q = clamp(at + ivec2(k % 3, k / 3) - 1, ivec2(0), size - 1);
      const int tap = q.y * size.x + q.x;
      const float z = texelFetch(depth, tap).x;
      closest = z < least ? tap : closest;
      least = min(z, least);
    }
  }
  dilated.data[index] = clamp(texelFetch(motion, closest).xy, -kFar, kFar);
}
