// Reads an estimate and the factors of the finest level, writes the corrected estimate.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/correct_params.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Params { BlockParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer estimate;
layout(set = 0, binding = 1) uniform samplerBuffer coarser;
layout(std430, set = 0, binding = 2) writeonly buffer CorrectedBuffer { vec4 data[]; } corrected;

#include "lib/read_factor.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  corrected.data[index] = texelFetch(estimate, index) * vec4(read_factor(at, ivec2(p.width_in, p.height_in), 1.0), 1.0);
}
