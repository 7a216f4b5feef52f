// Reads an image of patch statistics; writes its box sums along one direction; two passes sum a square patch.
// The pass along y leaves out the pixel's own row. The kernels that read the sums add the rest of that row,
// so that a pixel is never part of its own sums (subtracting it afterwards would leave the rounding error of
// a firefly's square). Patches are small (radius 2 to 8), so each sum is computed afresh and no rounding
// error travels along a row.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

layout(constant_id = 0) const int radius = 3;
layout(constant_id = 1) const int along_y = 0;  // 1: over the rows above and below, without the pixel's own
layout(constant_id = 2) const int strip = 1;    // pixels along the direction that one invocation computes

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 statistics_size; };
layout(set = 0, binding = 0) uniform samplerBuffer statistics;
layout(std430, set = 0, binding = 1) writeonly buffer SumBuffer { vec4 data[]; } sums;

void main() {
  const ivec2 invocation = ivec2(gl_GlobalInvocationID.xy);
  const ivec2 first = along_y != 0 ? ivec2(invocation.x, invocation.y * strip) : ivec2(invocation.x * strip, invocation.y);
  if (first.x >= statistics_size.x || first.y >= statistics_size.y) return;
  const int index = first.y * statistics_size.x + first.x;
  const int position = along_y != 0 ? first.y : first.x;
  const int length = along_y != 0 ? statistics_size.y : statistics_size.x;
  const int stride = along_y != 0 ? statistics_size.x : 1;
  vec4 sum[strip];
  [[unroll]] for (int s = 0; s < strip; ++s) sum[s] = vec4(0.0);
  [[unroll]] for (int i = -radius; i < radius + strip; ++i) {
    const bool inside = position + i >= 0 && position + i < length;
    const vec4 value = texelFetch(statistics, inside ? index + i * stride : index);
    [[unroll]] for (int s = 0; s < strip; ++s) {
      const bool counts = abs(i - s) <= radius && (along_y == 0 || i != s);
      if (counts) sum[s] += inside ? value : vec4(0.0);
    }
  }
  [[unroll]] for (int s = 0; s < strip; ++s) {
    if (position + s < length) sums.data[index + s * stride] = sum[s];
  }
}
