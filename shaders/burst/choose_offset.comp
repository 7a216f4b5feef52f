// Reads the column sums of differences at the offsets that the search found and at those of the motion of the
// whole picture; writes the latter unless the former's patch is closer by more than noise explains. The least
// of 25 distances is always less than that of the right offset: noise matches noise.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"

layout(constant_id = 0) const int radius = 3;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer sums;
layout(set = 0, binding = 1) uniform samplerBuffer found;
layout(set = 0, binding = 2) uniform samplerBuffer whole;
layout(std430, set = 0, binding = 3) writeonly buffer OffsetBuffer { vec2 data[]; } offset;

/// By how much the found offset's mean difference must be less: of the other's, and in deviations of the noise.
const float kRelative = 0.15;
const float kAbsolute = 0.2;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  vec2 sum = vec2(0.0);
  [[unroll]] for (int x = -radius; x <= radius; ++x) {
    sum += texelFetch(sums, at.y * size.x + clamp(at.x + x, 0, size.x - 1)).xy;
  }
  const float side = float(2 * radius + 1);
  const vec2 mean = sum / (side * side);
  const bool is_closer = mean.x < mean.y * (1.0 - kRelative) - kAbsolute;
  offset.data[index] = is_closer ? texelFetch(found, index).xy : texelFetch(whole, index).xy;
}
