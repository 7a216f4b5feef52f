// Reads sums over blocks, writes those of blocks twice as large.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/correct_params.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Params { BlockParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer fine;
layout(std430, set = 0, binding = 1) writeonly buffer CoarseBuffer { vec4 data[]; } coarse;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const ivec2 size = ivec2(p.width_in, p.height_in);
  vec4 sum = vec4(0.0);
  [[unroll]] for (int j = 0; j < 2; ++j) {
    [[unroll]] for (int i = 0; i < 2; ++i) {
      const ivec2 q = 2 * at + ivec2(i, j);
      const ivec2 tap = min(q, size - 1);
      const vec4 value = texelFetch(fine, tap.y * size.x + tap.x);
      sum += all(lessThan(q, size)) ? value : vec4(0.0);
    }
  }
  coarse.data[at.y * p.width + at.x] = sum;
}
