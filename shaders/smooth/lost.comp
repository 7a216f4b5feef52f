// Reads a frame, its variance and features, and the smoothed result; writes (excess, its square, variance of the
// frame, 1), relative to the result's brightness, to `lost` where there is a surface and to `lost_background` where
// there is none; zeros to the other one, and to both for a pixel that is not finite. The excess is the
// squared difference of frame and result minus the frame's variance.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"

layout(constant_id = 0) const int separate = 1;  // 0: all pixels count as surfaces

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer smoothed;
layout(set = 0, binding = 3) uniform samplerBuffer exposure;
layout(set = 0, binding = 4) uniform samplerBuffer albedo_depth;
layout(set = 0, binding = 5) uniform samplerBuffer normal;
layout(std430, set = 0, binding = 6) writeonly buffer LostBuffer { vec4 data[]; } lost;
layout(std430, set = 0, binding = 7) writeonly buffer BackgroundBuffer { vec4 data[]; } lost_background;

#include "lib/surface.glsl"

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
  const vec4 statistics = stats.y > 0.0 ? vec4(excess, excess * excess, noise, 1.0) : vec4(0.0);
  const bool background = separate != 0 && !shows_surface(index);
  lost.data[index] = background ? vec4(0.0) : statistics;
  if (separate != 0) lost_background.data[index] = background ? statistics : vec4(0.0);
}
