// Reads the reference's and a frame's features, the offsets that the search found and those of the motion of
// the whole picture; writes the differences at both: (found, whole).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/bilinear.glsl"
#include "lib/dispatch_size.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer target;
layout(set = 0, binding = 1) uniform samplerBuffer source;
layout(set = 0, binding = 2) uniform samplerBuffer found;
layout(set = 0, binding = 3) uniform samplerBuffer whole;
layout(std430, set = 0, binding = 4) writeonly buffer DifferenceBuffer { vec2 data[]; } difference;

float source_at(ivec2 at, vec2 displacement) {
  return bilinear_value(source, bilinear_taps(at, displacement, size), size.x, 0);
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const float x = texelFetch(target, index).x;
  difference.data[index] = vec2(abs(x - source_at(at, texelFetch(found, index).xy)),
                                abs(x - source_at(at, texelFetch(whole, index).xy)));
}
