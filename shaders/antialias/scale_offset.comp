// Reads the offsets that the search found at the samples' resolution; writes them at the pixels' resolution, in
// pixels, interpolated bilinearly.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/antialias_params.h"

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ivec2 size; ivec2 offset_coarse_size; ScaleOffsetParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer offset_coarse;
layout(std430, set = 0, binding = 1) writeonly buffer OffsetBuffer { vec2 data[]; } offset;

#include "lib/offset_field.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  offset.data[at.y * size.x + at.x] = read_offset(at, vec2(p.edge_x, p.edge_y), offset_coarse_size, p.scale);
}
