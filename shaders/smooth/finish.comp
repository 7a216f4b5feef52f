// Reads the finest scale's features and result, the frame, its albedo and, for a merged frame, the albedo of
// the frame itself; writes the smoothed radiance, multiplied by the mean of both albedos over windows that
// the network predicts, and (remaining variance, 1) from the error that the network expects. A pixel that is
// not finite stays as it is.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/gain.glsl"
#include "lib/network.glsl"
#include "lib/reflectance.glsl"

layout(constant_id = 0) const int planes = 4;  // of four features each
// 0: all albedos are 1; 1: the albedo of the frame itself is `albedo_depth`; 2: it is `own_albedo_depth`
layout(constant_id = 1) const int albedos = 2;

layout(local_size_x = 128, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; ivec2 affinities_size; };
layout(set = 0, binding = 0) uniform samplerBuffer features;
layout(set = 0, binding = 1) uniform samplerBuffer weights;
layout(set = 0, binding = 2) uniform samplerBuffer affinities;
layout(set = 0, binding = 3) uniform samplerBuffer irradiance;
layout(set = 0, binding = 4) uniform samplerBuffer color;
layout(set = 0, binding = 5) uniform samplerBuffer variance;
layout(set = 0, binding = 6) uniform samplerBuffer albedo_depth;
layout(set = 0, binding = 7) uniform samplerBuffer exposure;
layout(set = 0, binding = 8) uniform samplerBuffer own_albedo_depth;
layout(std430, set = 0, binding = 9) writeonly buffer SmoothedBuffer { vec4 data[]; } smoothed;
layout(std430, set = 0, binding = 10) writeonly buffer StatsBuffer { vec2 data[]; } stats;

#include "lib/window.glsl"

const int kMostOutputs = 2 * kTaps + 1;  // the last one is the log of the squared relative error
#include "lib/head.glsl"

/// What the albedos of the windows multiply by: their mean, by a softmax over the logits of `head`.
vec3 mean_divisor(ivec2 at, float head[kMostOutputs]) {
  const vec4 own_affinities = texelFetch(affinities, at.y * affinities_size.x + at.x);
  [[unroll]] for (int t = 0; t < kTaps; ++t) {
    const ivec2 tap = clamp(at + window_offset(t), ivec2(0), affinities_size - 1);
    const vec4 d = texelFetch(affinities, tap.y * affinities_size.x + tap.x) - own_affinities;
    head[t] -= dot(d, d);
    head[kTaps + t] -= dot(d, d);
  }
  float largest = head[0];
  [[unroll]] for (int t = 1; t < 2 * kTaps; ++t) largest = max(largest, head[t]);
  vec3 sum = vec3(0.0);
  float total = 0.0;
  [[unroll]] for (int t = 0; t < kTaps; ++t) {
    const ivec2 tap = clamp(at + window_offset(t), ivec2(0), size - 1);
    const int from = tap.y * size.x + tap.x;
    const float weight = exp(head[t] - largest);
    const float own_weight = exp(head[kTaps + t] - largest);
    const vec3 divisor = divisor_of(texelFetch(albedo_depth, from).rgb);
    const vec3 own_divisor = albedos == 2 ? divisor_of(texelFetch(own_albedo_depth, from).rgb) : divisor;
    sum += weight * divisor + own_weight * own_divisor;
    total += weight + own_weight;
  }
  return sum / total;
}

void main() {
  load_head(kMostOutputs);
  const ivec2 at = min(ivec2(gl_GlobalInvocationID.xy), size - 1);
  const int padded = at.y * affinities_size.x + at.x;
  float head[kMostOutputs];
  apply_head(kMostOutputs, padded, affinities_size.x * affinities_size.y, head);
  const vec3 divisor = albedos != 0 ? mean_divisor(at, head) : vec3(1.0);
  const int index = at.y * size.x + at.x;
  const float exposed_to = texelFetch(exposure, 0).x;
  const vec4 own = texelFetch(color, index);
  const vec2 own_stats = texelFetch(variance, index).xy;
  const vec3 exposed = texelFetch(irradiance, padded).rgb * divisor;
  const float left = variance_of_error(head[2 * kTaps], dot(exposed, exposed) / 3.0) / exposed_to / exposed_to;
  if (at != ivec2(gl_GlobalInvocationID.xy)) return;
  smoothed.data[index] = own_stats.y > 0.0 ? vec4(exposed / exposed_to, own.a) : own;
  stats.data[index] = own_stats.y > 0.0 ? vec2(min(left, kLargestVariance), 1.0) : own_stats;
}
