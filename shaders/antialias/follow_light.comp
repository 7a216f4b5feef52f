// Reads what light_ratio found for tiles; multiplies the warped history's colours by it in place, interpolated between
// tiles. Colours and variances are limited as those of frames; alpha stays as it is.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/bilinear.glsl"
#include "shared/antialias_params.h"
#include "shared/limits.h"

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; ivec2 light_size; int first_row; };
layout(set = 0, binding = 0) uniform samplerBuffer light;
layout(std430, set = 0, binding = 1) buffer ColorBuffer { vec4 data[]; } color;
layout(std430, set = 0, binding = 2) buffer StatsBuffer { vec2 data[]; } stats;

vec4 light_at(ivec2 at) {
  const BilinearTaps taps = bilinear_taps(at, vec2(0.0), light_size, float(kTile));
  const int top = taps.lo.y * light_size.x;
  const int bottom = taps.hi.y * light_size.x;
  return mix(mix(texelFetch(light, top + taps.lo.x), texelFetch(light, top + taps.hi.x), taps.t.x),
             mix(texelFetch(light, bottom + taps.lo.x), texelFetch(light, bottom + taps.hi.x), taps.t.x), taps.t.y);
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
  if (at.x >= size.x || at.y >= size.y) return;
  const vec4 ratio = light_at(at);
  if (ratio.rgb == vec3(1.0)) return;
  const int index = (at.y - first_row) * size.x + at.x;
  const vec4 found = color.data[index];
  color.data[index] = vec4(clamp(ratio.rgb * found.rgb, -kLargestScaled, kLargestScaled), found.a);
  const float of_variance = dot(ratio.rgb, ratio.rgb) / 3.0;
  stats.data[index].x = min(stats.data[index].x * of_variance, kLargestVariance);
}
