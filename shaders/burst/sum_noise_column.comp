// Reads differences; writes for each pixel the sums over its column of 2 * radius + 1 pixels: of the
// differences, of their squares, and their number; in the first plane of green samples, in the second of others.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"

layout(constant_id = 0) const int radius = 2;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer difference;
layout(std430, set = 0, binding = 1) writeonly buffer SumsBuffer { vec4 data[]; } sums;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  vec4 of_green = vec4(0.0);
  vec4 of_others = vec4(0.0);
  [[unroll]] for (int y = -radius; y <= radius; ++y) {
    const bool inside = at.y + y >= 0 && at.y + y < size.y;
    const vec2 d = texelFetch(difference, inside ? (at.y + y) * size.x + at.x : 0).xy;
    const vec4 added = vec4(d.x, d.x * d.x, 1.0, 0.0);
    of_green += inside && d.y > 0.0 ? added : vec4(0.0);
    of_others += inside && d.y < 0.0 ? added : vec4(0.0);
  }
  const int index = at.y * size.x + at.x;
  sums.data[index] = of_green;
  sums.data[size.x * size.y + index] = of_others;
}
