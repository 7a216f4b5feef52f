// Reads a mosaic and its green at every pixel; writes red and blue at every pixel: green, and the
// white-balanced difference to it of the samples of that colour around the pixel, by the weights of their place
// in the pattern. Differences of colours vary less than colours, and green has more samples.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/dispatch_size.glsl"
#include "lib/mosaic.glsl"

layout(constant_id = 0) const int period = 2;
layout(constant_id = 1) const int reach = 1;

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer mosaic;
layout(set = 0, binding = 1) uniform samplerBuffer green;
layout(set = 0, binding = 2) uniform samplerBuffer weights;
layout(set = 0, binding = 3) uniform samplerBuffer levels;
layout(set = 0, binding = 4) uniform samplerBuffer place;
layout(std430, set = 0, binding = 5) writeonly buffer RedBuffer { float data[]; } red;
layout(std430, set = 0, binding = 6) writeonly buffer BlueBuffer { float data[]; } blue;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int side = 2 * reach + 1;
  const ivec2 phase = (at + ivec2(texelFetch(place, 0).xy)) % period;
  const int row = (phase.y * period + phase.x) * 3 * side * side;
  // Green in units of red and blue.
  const float balance_green = texelFetch(levels, kBalance + 1).x;
  const vec2 ratio = balance_green / vec2(texelFetch(levels, kBalance).x, texelFetch(levels, kBalance + 2).x);
  const int index = at.y * size.x + at.x;
  vec2 sum = ratio * texelFetch(green, index).x;
  for (int y = -reach; y <= reach; ++y) {
    const int qy = mirrored(at.y + y, size.y, period);
    for (int x = -reach; x <= reach; ++x) {
      const int tap = qy * size.x + mirrored(at.x + x, size.x, period);
      const int k = row + (y + reach) * side + x + reach;
      const vec2 w = vec2(texelFetch(weights, k).x, texelFetch(weights, k + 2 * side * side).x);
      sum += w * (texelFetch(mosaic, tap).x - ratio * texelFetch(green, tap).x);
    }
  }
  red.data[index] = sum.x;
  blue.data[index] = sum.y;
}
