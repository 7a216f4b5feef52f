// Reads the new frame, its noise and an estimate of the same pixels; writes sums over blocks of 2x2 pixels, of those that
// have both: (r, g, b, pixels) of the frame, (r, g, b, variance of the frame) of the estimate, and half the difference of
// the frame's half-buffers, if there are any, which is noise alone.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/correct_params.h"

layout(constant_id = 0) const int halves = 0;  // 1: there are half-buffers

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Params { BlockParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer estimate;
layout(set = 0, binding = 3) uniform samplerBuffer estimate_stats;
layout(set = 0, binding = 4) uniform samplerBuffer half_difference;
layout(std430, set = 0, binding = 5) writeonly buffer FrameSumBuffer { vec4 data[]; } frame_sums;
layout(std430, set = 0, binding = 6) writeonly buffer EstimateSumBuffer { vec4 data[]; } estimate_sums;
layout(std430, set = 0, binding = 7) writeonly buffer HalfSumBuffer { vec4 data[]; } half_sums;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const ivec2 size = ivec2(p.width_in, p.height_in);
  vec4 frame_sum = vec4(0.0);
  vec4 estimate_sum = vec4(0.0);
  vec4 half_sum = vec4(0.0);
  [[unroll]] for (int j = 0; j < 2; ++j) {
    [[unroll]] for (int i = 0; i < 2; ++i) {
      const ivec2 q = 2 * at + ivec2(i, j);
      const ivec2 tap = min(q, size - 1);
      const int index = tap.y * size.x + tap.x;
      const vec2 sample_stats = texelFetch(variance, index).xy;
      const bool counts = all(lessThan(q, size)) && sample_stats.y > 0.0 && texelFetch(estimate_stats, index).y > 0.0;
      frame_sum += counts ? vec4(texelFetch(color, index).rgb, 1.0) : vec4(0.0);
      estimate_sum += counts ? vec4(texelFetch(estimate, index).rgb, sample_stats.x) : vec4(0.0);
      if (halves != 0) half_sum += counts ? texelFetch(half_difference, index) : vec4(0.0);
    }
  }
  const int block = at.y * p.width + at.x;
  frame_sums.data[block] = frame_sum;
  estimate_sums.data[block] = estimate_sum;
  if (halves != 0) half_sums.data[block] = half_sum;
}
