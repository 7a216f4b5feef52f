// Reads the ratio of the frame's scale to the history's, a power of two; brings the warped history to the
// frame's scale, in place. Colours and variances are limited as those of frames; alpha stays as it is.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/limits.h"

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; int first_row; };
layout(set = 0, binding = 0) uniform samplerBuffer ratio;
layout(std430, set = 0, binding = 1) buffer ColorBuffer { vec4 data[]; } color;
layout(std430, set = 0, binding = 2) buffer StatsBuffer { vec2 data[]; } stats;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
  const float r = texelFetch(ratio, 0).x;
  if (at.x >= size.x || at.y >= size.y || r == 1.0) return;
  const int index = (at.y - first_row) * size.x + at.x;
  const vec4 found = color.data[index];
  color.data[index] = vec4(clamp(r * found.rgb, -kLargestScaled, kLargestScaled), found.a);
  stats.data[index].x = min(stats.data[index].x * r * r, kLargestVariance);
}
