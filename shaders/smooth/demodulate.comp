// Reads a frame and its features; writes for the padded frame the radiance without albedo, in units of the
// frame's typical luminance (a: 1, or 0 for a pixel that is not finite), and the range-compressed grey value,
// of which smooth/inputs takes the local deviation.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/gain.glsl"
#include "lib/network.glsl"
#include "lib/reflectance.glsl"

layout(constant_id = 0) const int has_grey = 1;  // 0: `grey` is not wanted

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; ivec2 color_size; };
layout(set = 0, binding = 0) uniform samplerBuffer color;
layout(set = 0, binding = 1) uniform samplerBuffer variance;
layout(set = 0, binding = 2) uniform samplerBuffer albedo_depth;
layout(set = 0, binding = 3) uniform samplerBuffer exposure;
layout(std430, set = 0, binding = 4) writeonly buffer IrradianceBuffer { vec4 data[]; } irradiance;
layout(std430, set = 0, binding = 5) writeonly buffer GreyBuffer { float data[]; } grey;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int from = min(at.y, color_size.y - 1) * color_size.x + min(at.x, color_size.x - 1);
  const vec3 divisor = divisor_of(texelFetch(albedo_depth, from).rgb);
  const vec3 divided = texelFetch(color, from).rgb * texelFetch(exposure, 0).x / divisor;
  const vec3 value = clamp(divided, vec3(-kLargestDifference), vec3(kLargestDifference));
  const int index = at.y * size.x + at.x;
  irradiance.data[index] = vec4(value, texelFetch(variance, from).y);
  if (has_grey == 0) return;
  const vec3 compressed = vec3(compressed_radiance(value.r), compressed_radiance(value.g), compressed_radiance(value.b));
  grey.data[index] = (compressed.r + compressed.g + compressed.b) / 3.0;
}
