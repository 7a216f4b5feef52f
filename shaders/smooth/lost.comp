// Reads a frame, its variance and the smoothed result; writes (excess, its square, variance of the frame, 1),
// relative to the result's brightness; zeros for a pixel that is not finite. The excess is what the squared
// difference of both is more than the frame's noise alone would make it, on average.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer smoothed;
layout(set = 0, binding = 3) uniform samplerBuffer exposure;
layout(std430, set = 0, binding = 4) writeonly buffer LostBuffer { vec4 data[]; } lost;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec4 y = texelFetch(smoothed, index);
  const vec2 stats = texelFetch(variance, index).xy;
  const float scale = 1.0 / brightness(y.r, y.g, y.b, texelFetch(exposure, 0).x);
  const vec3 d = clamp((texelFetch(color, index).rgb - y.rgb) * scale, -kLargestDifference, kLargestDifference);
  const float deviation = min(sqrt(max(stats.x, 0.0)) * scale, kLargestDifference);
  const float noise = deviation * deviation;
  const float excess = dot(d, d) / 3.0 - noise;
  lost.data[index] = stats.y > 0.0 ? vec4(excess, excess * excess, noise, 1.0) : vec4(0.0);
}
