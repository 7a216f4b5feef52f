// Reads the offsets at matching resolution; writes them at full resolution in full-resolution pixels,
// interpolated bilinearly. An invocation makes the pixels of one row that one coarse pixel covers; they share
// their taps.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/bilinear.glsl"
#include "shared/align_params.h"

layout(constant_id = 0) const int scale = 2;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { UpsampleParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer offset_coarse;
layout(std430, set = 0, binding = 1) writeonly buffer OffsetBuffer { vec2 data[]; } offset;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width_in || at.y >= p.height) return;
  const BilinearTaps rows = bilinear_taps(ivec2(0, at.y), vec2(0.0), ivec2(1, p.height_in), float(scale));
  vec2 column[3];
  [[unroll]] for (int i = 0; i < 3; ++i) {
    const int x = clamp(at.x + i - 1, 0, p.width_in - 1);
    column[i] = mix(texelFetch(offset_coarse, rows.lo.y * p.width_in + x).xy,
                    texelFetch(offset_coarse, rows.hi.y * p.width_in + x).xy, rows.t.y);
  }
  [[unroll]] for (int i = 0; i < scale; ++i) {
    const int x = at.x * scale + i;
    const float position = (float(i) + 0.5) / float(scale) - 0.5;
    const vec2 here = position < 0.0 ? mix(column[0], column[1], 1.0 + position) : mix(column[1], column[2], position);
    if (x < p.width) offset.data[at.y * p.width + x] = float(scale) * here;
  }
}
