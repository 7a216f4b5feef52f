// Reads an additive AOV without albedo and the beauty's confidence, both of the finer scale; writes this scale's
// AOV: the mean of each 2x2 pixels weighted by their confidences, as smooth/reduce has it.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"

layout(local_size_x = 128, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer finer;
layout(set = 0, binding = 1) uniform samplerBuffer irradiance_confidence;
layout(std430, set = 0, binding = 2) writeonly buffer LightBuffer { vec4 data[]; } light;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  vec3 sum = vec3(0.0);
  float total = 0.0;
  [[unroll]] for (int i = 0; i < 4; ++i) {
    const int from = (2 * at.y + i / 2) * 2 * size.x + 2 * at.x + i % 2;
    const float confidence = texelFetch(irradiance_confidence, from).a;
    sum += confidence * texelFetch(finer, from).rgb;
    total += confidence;
  }
  light.data[at.y * size.x + at.x] = vec4(sum / max(total, 1e-30), 0.0);
}
