// Reads a frame, its variance and its features; writes the radiance without the albedo, in units of the frame's typical
// luminance (a: 1, or 0 for a pixel that is not finite), and what patches are compared by: (luminance of that, its variance
// averaged over 3x3 pixels, but no more than its own by far). A frame's variances are means over channels: they are taken for those of light with even noise
// on this albedo, since each channel's own divisor would blow them up by the darkest.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/color.glsl"
#include "lib/gain.glsl"
#include "lib/reflectance.glsl"
#include "shared/smooth_params.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Params { SmoothParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer albedo_depth;
layout(set = 0, binding = 3) uniform samplerBuffer exposure;
layout(std430, set = 0, binding = 4) writeonly buffer IrradianceBuffer { vec4 data[]; } irradiance;
layout(std430, set = 0, binding = 5) writeonly buffer GuideBuffer { vec2 data[]; } guide;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  const float scale = texelFetch(exposure, 0).x;
  const float largest = kLargestDifference;
  float own_noise = 0.0;
  float noise = 0.0;
  float count = 0.0;
  [[unroll]] for (int j = -1; j <= 1; ++j) {
    [[unroll]] for (int i = -1; i <= 1; ++i) {
      const ivec2 tap = clamp(at + ivec2(i, j), ivec2(0), ivec2(p.width, p.height) - 1);
      const int tap_index = tap.y * p.width + tap.x;
      const vec2 stats = texelFetch(variance, tap_index).xy;
      const vec3 divisor = divisor_of(texelFetch(albedo_depth, tap_index).rgb) / scale;
      const float tap_noise = stats.y > 0.0 ? min(stats.x / variance_divisor_of(divisor), largest * largest) : 0.0;
      noise += tap_noise;
      count += stats.y;
      own_noise = i == 0 && j == 0 ? tap_noise : own_noise;
    }
  }
  const vec3 divided = texelFetch(color, index).rgb * scale / divisor_of(texelFetch(albedo_depth, index).rgb);
  const vec3 value = clamp(divided, vec3(-largest), vec3(largest));
  irradiance.data[index] = vec4(value, texelFetch(variance, index).y);
  const float light = luminance(value.r, value.g, value.b);
  guide.data[index] = vec2(light, borrowed_variance(noise / max(count, 1.0), own_noise, max(abs(light), 1.0)));
}
