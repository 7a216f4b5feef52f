// Reads the history of an additive AOV and the albedo of the history's last frame; writes the AOV divided by
// that albedo, as merge/demodulate_history does with the beauty.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/dispatch_size.glsl"
#include "lib/reflectance.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer albedo;
layout(std430, set = 0, binding = 2) writeonly buffer IrradianceBuffer { vec4 data[]; } irradiance;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec4 value = texelFetch(color, index);
  irradiance.data[index] = vec4(value.rgb / divisor_of(texelFetch(albedo, index).rgb), value.a);
}
