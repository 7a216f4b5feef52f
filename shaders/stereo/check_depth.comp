// Reads each pixel's offset into the other eye's image, the depth that is expected there, and the other eye's
// depth; writes the offset, or one that leads out of every image where none of the four nearest pixels has the
// expected depth: another surface hides the pixel's from the other eye. An expected depth of 0 is not known.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/bilinear.glsl"
#include "lib/stereo.glsl"
#include "shared/limits.h"

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; ivec2 other_depth_size; };
layout(set = 0, binding = 0) uniform samplerBuffer offset_given;
layout(set = 0, binding = 1) uniform samplerBuffer expected_depth;
layout(set = 0, binding = 2) uniform samplerBuffer other_depth;
layout(set = 0, binding = 3) uniform samplerBuffer target_origin;
layout(std430, set = 0, binding = 4) writeonly buffer OffsetBuffer { vec2 data[]; } offset;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec2 given = texelFetch(offset_given, index).xy;
  const float expected = texelFetch(expected_depth, index).x;
  const BilinearTaps taps = bilinear_taps(ivec2(texelFetch(target_origin, 0).xy) + at, given, other_depth_size);
  bool found = !(expected > 0.0);
  [[unroll]] for (int j = 0; j < 2; ++j) {
    [[unroll]] for (int i = 0; i < 2; ++i) {
      const int y = j == 0 ? taps.lo.y : taps.hi.y;
      const int x = i == 0 ? taps.lo.x : taps.hi.x;
      found = found || is_expected_depth(texelFetch(other_depth, y * other_depth_size.x + x).x, expected);
    }
  }
  offset.data[index] = found ? given : vec2(kNowhere);
}
