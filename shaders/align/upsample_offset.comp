// Reads the offsets at matching resolution, writes them at full resolution in full-resolution pixels, bilinearly.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/align_params.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Params { UpsampleParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer offset_coarse;
layout(std430, set = 0, binding = 1) writeonly buffer OffsetBuffer { vec2 data[]; } offset;

#include "lib/offset_field.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  offset.data[at.y * p.width + at.x] = read_offset(at, vec2(0.0), ivec2(p.width_in, p.height_in), p.scale);
}
