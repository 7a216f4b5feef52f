// Reads colours; writes what choose_offset compares: their luminance, exposed and compressed to [0,1).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer exposure;
layout(std430, set = 0, binding = 2) writeonly buffer FeatureBuffer { float data[]; } feature;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec3 c = texelFetch(color, index).rgb;
  feature.data[index] = compress(exposed(luminance(c.r, c.g, c.b), texelFetch(exposure, 0).x));
}
