// Reads a history and the albedo of its last frame; writes the history's radiance divided by that albedo,
// with statistics to match. Texture then comes from each frame's own albedo, and repeated resampling blurs
// the light alone.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/dispatch_size.glsl"
#include "lib/reflectance.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer stats;
layout(set = 0, binding = 2) uniform samplerBuffer albedo;
layout(std430, set = 0, binding = 3) writeonly buffer IrradianceBuffer { vec4 data[]; } irradiance;
layout(std430, set = 0, binding = 4) writeonly buffer IrradianceStatsBuffer { vec2 data[]; } irradiance_stats;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec3 divisor = divisor_of(texelFetch(albedo, index).rgb);
  const vec4 value = texelFetch(color, index);
  irradiance.data[index] = vec4(value.rgb / divisor, value.a);
  // At most kLargestVariance / 0.04^2, so that sums stay within the range of floats.
  const vec2 of_value = texelFetch(stats, index).xy;
  irradiance_stats.data[index] = vec2(of_value.x / variance_divisor_of(divisor), of_value.y);
}
