// Reads offsets from target to source and from source to target, both at full resolution; writes how much the way there
// can be trusted: 1 where the way back ends where it began, 1/2 where it ends a pixel away.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/align_params.h"

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { FieldParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer there;
layout(set = 0, binding = 1) uniform samplerBuffer offset_coarse;  // the way back
layout(std430, set = 0, binding = 2) writeonly buffer ConfidenceBuffer { float data[]; } confidence;

#include "lib/offset_field.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int i = at.y * p.width + at.x;
  const vec2 way = texelFetch(there, i).xy;
  const vec2 error = way + read_offset(at, way, ivec2(p.width, p.height), 1.0);
  const vec2 end = vec2(at) + way;
  const bool leaves = any(lessThan(end, vec2(-0.5))) || any(greaterThan(end, vec2(p.width, p.height) - 0.5));
  confidence.data[i] = leaves ? 0.0 : 1.0 / (1.0 + dot(error, error));
}
