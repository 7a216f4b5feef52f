// Reads the finer scale's irradiance with confidence and this scale's features; writes this scale's
// irradiance, the mean of each 2x2 pixels weighted by their confidences, with their mean confidence times the
// network's confidence at this scale; and the pixel's affinities.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"
#include "lib/network.glsl"

layout(constant_id = 0) const int planes = 4;  // of four features each
layout(constant_id = 1) const int framed = 0;  // as lib/head.glsl has it

layout(local_size_x = 128, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer features;
layout(set = 0, binding = 1) uniform samplerBuffer weights;
layout(set = 0, binding = 2) uniform samplerBuffer finer;
layout(std430, set = 0, binding = 3) writeonly buffer ConfidenceBuffer { vec4 data[]; } irradiance_confidence;
layout(std430, set = 0, binding = 4) writeonly buffer AffinitiesBuffer { vec4 data[]; } affinities;

const int kMostOutputs = 5;  // the confidence, then the affinities
const int strip = 1;
#include "lib/head.glsl"

void main() {
  load_head(kMostOutputs);
  const ivec2 at = min(ivec2(gl_GlobalInvocationID.xy), size - 1);
  const int index = at.y * size.x + at.x;
  apply_head(kMostOutputs, at, size);
  vec3 sum = vec3(0.0);
  float total = 0.0;
  [[unroll]] for (int i = 0; i < 4; ++i) {
    const vec4 value = texelFetch(finer, (2 * at.y + i / 2) * 2 * size.x + 2 * at.x + i % 2);
    sum += value.a * value.rgb;
    total += value.a;
  }
  if (at != ivec2(gl_GlobalInvocationID.xy)) return;
  irradiance_confidence.data[index] = vec4(sum / max(total, 1e-30), 0.25 * total * confidence(head[0]));
  affinities.data[index] = vec4(head[1], head[2], head[3], head[4]);
}
