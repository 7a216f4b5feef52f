// Reads the offsets at matching resolution; writes them at full resolution in full-resolution pixels,
// interpolated bilinearly. An invocation makes the pixels of one row that one coarse pixel covers; they share
// their taps.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/bilinear.glsl"

layout(constant_id = 0) const int scale = 2;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 offset_size; ivec2 offset_coarse_size; };
layout(set = 0, binding = 0) uniform samplerBuffer offset_coarse;
layout(std430, set = 0, binding = 1) writeonly buffer OffsetBuffer { vec2 data[]; } offset;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= offset_coarse_size.x || at.y >= offset_size.y) return;
  const BilinearTaps rows = bilinear_taps(ivec2(0, at.y), vec2(0.0), ivec2(1, offset_coarse_size.y), float(scale));
  vec2 column[3];
  [[unroll]] for (int i = 0; i < 3; ++i) {
    const int x = clamp(at.x + i - 1, 0, offset_coarse_size.x - 1);
    column[i] = mix(texelFetch(offset_coarse, rows.lo.y * offset_coarse_size.x + x).xy,
                    texelFetch(offset_coarse, rows.hi.y * offset_coarse_size.x + x).xy, rows.t.y);
  }
  [[unroll]] for (int i = 0; i < scale; ++i) {
    const int x = at.x * scale + i;
    const float position = (float(i) + 0.5) / float(scale) - 0.5;
    const vec2 here = position < 0.0 ? mix(column[0], column[1], 1.0 + position) : mix(column[1], column[2], position);
    if (x < offset_size.x) offset.data[at.y * offset_size.x + x] = float(scale) * here;
  }
}
