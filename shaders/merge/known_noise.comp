// Reads a noisy layer (radiance, variance) and the patch sums of merge/repeated_noise; writes the layer with
// its variance lowered to what differs from frame to frame. An estimate from one frame mistakes detail that
// no feature explains for noise, and renderers that stratify their samples overstate the variance.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"

layout(local_size_x = 64, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer noisy;
layout(set = 0, binding = 1) uniform samplerBuffer statistics;
layout(set = 0, binding = 2) uniform samplerBuffer statistics_sums;
layout(std430, set = 0, binding = 3) writeonly buffer KnownBuffer { vec4 data[]; } known;

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec4 sum = texelFetch(statistics_sums, index);
  const vec4 value = texelFetch(noisy, index);
  // A firefly among calm pixels keeps its variance, since its own difference is large.
  const vec4 own = texelFetch(statistics, index);
  const float repeated = sum.z >= 1.0 && sum.x < sum.y ? sum.x / sum.y : 1.0;
  const float share = own.z > 0.0 && own.x < own.y ? max(repeated, own.x / own.y) : 1.0;
  known.data[index] = vec4(value.rgb, value.a * share);
}
