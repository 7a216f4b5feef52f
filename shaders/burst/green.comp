// Reads a mosaic; writes green at every pixel: the sample, or where it has another colour the green samples
// around it by the weights of their place in the pattern. `place` is the position of the image's first pixel
// in the pattern.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/dispatch_size.glsl"
#include "lib/mosaic.glsl"

layout(constant_id = 0) const int period = 2;
layout(constant_id = 1) const int reach = 1;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer mosaic;
layout(set = 0, binding = 1) uniform samplerBuffer weights;
layout(set = 0, binding = 2) uniform samplerBuffer place;
layout(std430, set = 0, binding = 3) writeonly buffer GreenBuffer { float data[]; } green;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int side = 2 * reach + 1;
  const ivec2 phase = (at + ivec2(texelFetch(place, 0).xy)) % period;
  const int row = ((phase.y * period + phase.x) * 3 + 1) * side * side;
  float sum = 0.0;
  for (int y = -reach; y <= reach; ++y) {
    const int qy = mirrored(at.y + y, size.y, period);
    for (int x = -reach; x <= reach; ++x) {
      const int qx = mirrored(at.x + x, size.x, period);
      const float w = texelFetch(weights, row + (y + reach) * side + x + reach).x;
      sum += w * texelFetch(mosaic, qy * size.x + qx).x;
    }
  }
  green.data[at.y * size.x + at.x] = sum;
}
