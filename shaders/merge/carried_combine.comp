// Reads the forward and backward estimates of a carried image (an additive AOV or a noisy layer) and the
// weight of the beauty's backward estimate (merge/combine); writes their combination.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/dispatch_size.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer forward_color;
layout(set = 0, binding = 1) uniform samplerBuffer backward_color;
layout(set = 0, binding = 2) uniform samplerBuffer weight;
layout(std430, set = 0, binding = 3) writeonly buffer CombinedBuffer { vec4 data[]; } combined;

#include "lib/combine.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  combined.data[index] =
      combine(texelFetch(forward_color, index), texelFetch(backward_color, index), texelFetch(weight, index).x);
}
