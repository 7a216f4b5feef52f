// Reads the new frame's noisy layer (radiance, variance), which of its pixels are finite, and the same layer of
// the warped history; writes the statistics from which known_noise finds how much of the variance differs from
// frame to frame: (squared difference scaled to one frame's noise, variance, 1, 0), relative to the history's
// brightness; zeros where there is no history and for pixels that are not finite.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer noisy;
layout(set = 0, binding = 1) uniform samplerBuffer warped_noisy;
layout(set = 0, binding = 2) uniform samplerBuffer warped_stats;
layout(set = 0, binding = 3) uniform samplerBuffer exposure;
layout(set = 0, binding = 4) uniform samplerBuffer variance;
layout(std430, set = 0, binding = 5) writeonly buffer StatisticsBuffer { vec4 data[]; } statistics;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec4 x = texelFetch(noisy, index);
  const vec4 h = texelFetch(warped_noisy, index);
  const float frames = texelFetch(warped_stats, index).y;
  const float scale = 1.0 / brightness(h.r, h.g, h.b, texelFetch(exposure, 0).x);
  const vec3 d = clamp((x.rgb - h.rgb) * scale, -kLargestDifference, kLargestDifference);
  // The difference of a frame and a mean of n has (n + 1) / n times a frame's variance.
  const float of_frame = dot(d, d) / 3.0 * frames / (frames + 1.0);
  const float noise = min(x.a * scale * scale, kLargestDifference * kLargestDifference);
  const bool counts = frames > 0.0 && texelFetch(variance, index).y > 0.0;
  statistics.data[index] = counts ? vec4(of_frame, noise, 1.0, 0.0) : vec4(0.0);
}
