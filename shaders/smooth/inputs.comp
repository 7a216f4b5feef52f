// Reads a frame's outputs of smooth/demodulate, its variance and its features; writes the network's first input
// channels: compressed radiance, albedo, normal, depth, relative noise, local deviation of the grey value over 5x5
// pixels.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/color.glsl"
#include "lib/network.glsl"
#include "lib/reflectance.glsl"

layout(constant_id = 0) const int variance_known = 1;  // 0: the noise is not known

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; ivec2 albedo_depth_size; };
layout(set = 0, binding = 0) uniform samplerBuffer irradiance;
layout(set = 0, binding = 1) uniform samplerBuffer grey;
layout(set = 0, binding = 2) uniform samplerBuffer variance;
layout(set = 0, binding = 3) uniform samplerBuffer albedo_depth;
layout(set = 0, binding = 4) uniform samplerBuffer normal;
layout(set = 0, binding = 5) uniform samplerBuffer exposure;
layout(std430, set = 0, binding = 6) writeonly buffer RadianceBuffer { vec4 data[]; } radiance_inputs;
layout(std430, set = 0, binding = 7) writeonly buffer SurfaceBuffer { vec4 data[]; } surface_inputs;
layout(std430, set = 0, binding = 8) writeonly buffer NoiseBuffer { vec4 data[]; } noise_inputs;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const float centre = texelFetch(grey, index).x;
  // Differences from the pixel itself keep the deviation of even surfaces at exactly 0.
  float sum = 0.0;
  float squares = 0.0;
  [[unroll]] for (int j = -2; j <= 2; ++j) {
    [[unroll]] for (int i = -2; i <= 2; ++i) {
      const ivec2 tap = clamp(at + ivec2(i, j), ivec2(0), size - 1);
      const float d = texelFetch(grey, tap.y * size.x + tap.x).x - centre;
      sum += d;
      squares += d * d;
    }
  }
  const float deviation = sqrt(max(squares / 25.0 - (sum / 25.0) * (sum / 25.0), 0.0));

  const int from = min(at.y, albedo_depth_size.y - 1) * albedo_depth_size.x + min(at.x, albedo_depth_size.x - 1);
  const vec4 value = texelFetch(irradiance, index);
  const vec4 features = texelFetch(albedo_depth, from);
  const vec3 n = texelFetch(normal, from).xyz;
  float noise = kNoiseUnknown;
  if (variance_known != 0) {
    const float exposed_deviation = sqrt(max(texelFetch(variance, from).x, 0.0)) * texelFetch(exposure, 0).x;
    // A variance is a mean over channels.
    const float divisor = length(divisor_of(features.rgb)) / sqrt(3.0);
    noise = told_noise(exposed_deviation / divisor, luminance(value.r, value.g, value.b));
  }
  radiance_inputs.data[index] = vec4(compressed_radiance(value.r), compressed_radiance(value.g), compressed_radiance(value.b), features.r);
  surface_inputs.data[index] = vec4(features.g, features.b, n.x, n.y);
  noise_inputs.data[index] = vec4(n.z, features.a, noise, deviation);
}
