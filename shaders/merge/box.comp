// Sums over square patches without the pixel in their middle, in two passes. The one along x reads patch
// statistics and writes their sums over rows, with the pixel and without it; the one along y reads both and
// writes the sums over the rows above and below, with the row beside the pixel. So a pixel is never part of its
// own sums (subtracting it afterwards would leave the rounding error of a firefly's square). Patches are small
// (radius 2 to 8), so each sum is computed afresh and no rounding error travels along a row.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require

layout(constant_id = 0) const int radius = 3;
layout(constant_id = 1) const int along_y = 0;
layout(constant_id = 2) const int strip = 1;  // pixels along the direction that one invocation computes

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 statistics_size; };
layout(set = 0, binding = 0) uniform samplerBuffer statistics;
layout(set = 0, binding = 1) uniform samplerBuffer beside;  // read along y
layout(std430, set = 0, binding = 2) writeonly buffer SumBuffer { vec4 data[]; } sums;
layout(std430, set = 0, binding = 3) writeonly buffer BesideBuffer { vec4 data[]; } new_beside;  // written along x

void main() {
  const ivec2 invocation = ivec2(gl_GlobalInvocationID.xy);
  const ivec2 first = along_y != 0 ? ivec2(invocation.x, invocation.y * strip) : ivec2(invocation.x * strip, invocation.y);
  if (first.x >= statistics_size.x || first.y >= statistics_size.y) return;
  const int index = first.y * statistics_size.x + first.x;
  const int position = along_y != 0 ? first.y : first.x;
  const int length = along_y != 0 ? statistics_size.y : statistics_size.x;
  const int stride = along_y != 0 ? statistics_size.x : 1;
  vec4 sum[strip];  // without the pixel, or its row
  vec4 own[strip];
  [[unroll]] for (int s = 0; s < strip; ++s) sum[s] = vec4(0.0);
  [[unroll]] for (int i = -radius; i < radius + strip; ++i) {
    const bool inside = position + i >= 0 && position + i < length;
    const vec4 value = texelFetch(statistics, inside ? index + i * stride : index);
    [[unroll]] for (int s = 0; s < strip; ++s) {
      if (i == s) {
        own[s] = value;
      } else if (abs(i - s) <= radius) {
        sum[s] += inside ? value : vec4(0.0);
      }
    }
  }
  [[unroll]] for (int s = 0; s < strip; ++s) {
    if (position + s >= length) continue;
    const int at = index + s * stride;
    if (along_y != 0) {
      sums.data[at] = sum[s] + texelFetch(beside, at);
    } else {
      sums.data[at] = sum[s] + own[s];
      new_beside.data[at] = sum[s];
    }
  }
}
