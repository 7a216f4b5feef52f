// For patches too large for `match`: reads the 25 images of patch sums of a band and the coarser level's offsets; writes
// each pixel's offset at this level and its residual.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/distance.glsl"
#include "shared/align_params.h"

layout(constant_id = 0) const int kind = kDistanceLogL1Centered;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { SelectParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer sums;
layout(set = 0, binding = 1) uniform samplerBuffer offset_coarse;
layout(std430, set = 0, binding = 2) writeonly buffer OffsetBuffer { vec2 data[]; } offset;
layout(std430, set = 0, binding = 3) writeonly buffer ResidualBuffer { float data[]; } residual;

#include "lib/choice.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.rows) return;
  float cost[25];
  [[unroll]] for (int k = 0; k < 25; ++k) cost[k] = texelFetch(sums, (k * p.rows + at.y) * p.width + at.x).x;
  choose(kind, cost, ivec2(at.x, p.first_row + at.y), ivec2(p.width, p.height), p.radius, p.refine != 0,
         ivec2(p.coarse_width, p.coarse_height), p.coarse_scale);
}
