// Reads the source's features of one level and the coarser level's offsets; writes the source as seen from
// each target pixel's start, source(p + start(p)), so that the level searches a regular image (the warp of
// Hanika et al. 2021, figure 4). If the source's images cover more of the frame than the target's, the
// target's first pixel lies at target_origin in them.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/align_params.h"

layout(constant_id = 0) const int planes = 1;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ivec2 size; ivec2 source_size; ivec2 offset_coarse_size; WarpSourceParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer source;
layout(set = 0, binding = 1) uniform samplerBuffer offset_coarse;
layout(set = 0, binding = 2) uniform samplerBuffer target_origin;
layout(std430, set = 0, binding = 3) writeonly buffer WarpedBuffer { float data[]; } warped;

#include "lib/offset_field.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const vec2 start = read_offset(at, vec2(0.0), offset_coarse_size, p.coarse_scale);
  const ivec2 origin = ivec2(texelFetch(target_origin, 0).xy) / p.level_px;
  const BilinearTaps taps = bilinear_taps(origin + at, start, source_size);
  [[unroll]] for (int plane = 0; plane < planes; ++plane) {
    warped.data[(plane * size.y + at.y) * size.x + at.x] =
        bilinear_value(source, taps, source_size.x, plane * source_size.y);
  }
}
