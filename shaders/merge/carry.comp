// Reads the new frame and its variance; writes both in one image, (radiance, variance), so that the noisy
// radiance can be merged with the weights of smoothed frames.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/dispatch_size.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(std430, set = 0, binding = 2) writeonly buffer CarriedBuffer { vec4 data[]; } carried;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  carried.data[index] = vec4(texelFetch(color, index).rgb, texelFetch(variance, index).x);
}
