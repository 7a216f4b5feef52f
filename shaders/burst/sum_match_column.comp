// Reads pairs of differences; writes for each pixel their sums over its column of 2 * radius + 1 pixels, where the
// image's border repeats.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"

layout(constant_id = 0) const int radius = 3;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer difference;
layout(std430, set = 0, binding = 1) writeonly buffer SumsBuffer { vec2 data[]; } sums;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  vec2 sum = vec2(0.0);
  [[unroll]] for (int y = -radius; y <= radius; ++y) {
    sum += texelFetch(difference, clamp(at.y + y, 0, size.y - 1) * size.x + at.x).xy;
  }
  sums.data[at.y * size.x + at.x] = sum;
}
