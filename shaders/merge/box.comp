// Reads an image of patch statistics; writes its box sums along one direction; two passes sum a square patch.
// The pass along y leaves out the pixel's own row. The kernels that read the sums add the rest of that row,
// so that a pixel is never part of its own sums (subtracting it afterwards would leave the rounding error of
// a firefly's square). Patches are small (radius 1 to 8), so each sum is computed afresh and no rounding
// error travels along a row.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"

layout(constant_id = 0) const int radius = 3;
layout(constant_id = 1) const int along_y = 0;  // 1: over the rows above and below, without the pixel's own

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer statistics;
layout(std430, set = 0, binding = 1) writeonly buffer SumBuffer { vec4 data[]; } sums;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const int position = along_y != 0 ? at.y : at.x;
  const int length = along_y != 0 ? size.y : size.x;
  const int stride = along_y != 0 ? size.x : 1;
  vec4 sum = vec4(0.0);
  [[unroll]] for (int i = -radius; i <= radius; ++i) {
    if (along_y != 0 && i == 0) continue;
    const bool inside = position + i >= 0 && position + i < length;
    const vec4 value = texelFetch(statistics, inside ? index + i * stride : index);
    sum += inside ? value : vec4(0.0);
  }
  sums.data[index] = sum;
}
