// Reads the finest scale's result for an additive AOV, what smooth/finish multiplies the beauty by, and the AOV
// as it came; writes the smoothed AOV. A pixel that is not finite stays as it is.
#version 460
#extension GL_GOOGLE_include_directive : require

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 color_size; ivec2 irradiance_size; };
layout(set = 0, binding = 0) uniform samplerBuffer irradiance;
layout(set = 0, binding = 1) uniform samplerBuffer divisor;
layout(set = 0, binding = 2) uniform samplerBuffer color;
layout(set = 0, binding = 3) uniform samplerBuffer variance;
layout(set = 0, binding = 4) uniform samplerBuffer exposure;
layout(std430, set = 0, binding = 5) writeonly buffer SmoothedBuffer { vec4 data[]; } smoothed;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= color_size.x || at.y >= color_size.y) return;
  const int index = at.y * color_size.x + at.x;
  const vec4 own = texelFetch(color, index);
  const vec3 exposed = texelFetch(irradiance, at.y * irradiance_size.x + at.x).rgb * texelFetch(divisor, index).rgb;
  const bool is_finite = texelFetch(variance, index).y > 0.0;
  smoothed.data[index] = is_finite ? vec4(exposed / texelFetch(exposure, 0).x, own.a) : own;
}
