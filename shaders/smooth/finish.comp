// Reads the finest scale's features and result, the frame, its albedo and, for a merged frame, the albedo of
// the frame itself; writes the smoothed radiance, multiplied by the mean of both albedos over windows that
// the network predicts, and (remaining variance, 1) from the error that the network expects; if asked, also the
// mean of the albedos, for smooth/finish_light. A pixel that is not finite stays as it is.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/network.glsl"
#include "lib/reflectance.glsl"
#include "shared/limits.h"

layout(constant_id = 0) const int planes = 4;  // of four features each
// 0: all albedos are 1; 1: the albedo of the frame itself is `albedo_depth`; 2: it is `own_albedo_depth`
layout(constant_id = 1) const int albedos = 2;
layout(constant_id = 2) const int strip = 1;   // rows of pixels that one invocation computes
layout(constant_id = 3) const int framed = 0;  // as lib/head.glsl has it
layout(constant_id = 4) const int has_lights = 0;  // 1: `divisor` is wanted

layout(local_size_x = 128, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 color_size; ivec2 affinities_size; };
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
layout(std430, set = 0, binding = 11) writeonly buffer DivisorBuffer { vec4 data[]; } divisor;

#include "lib/window.glsl"

const int kMostOutputs = 2 * kTaps + 1;  // the last one is the log of the squared relative error
#include "lib/head.glsl"

void subtract_distances(ivec2 first) {
  vec4 middle[strip];
  [[unroll]] for (int s = 0; s < strip; ++s) middle[s] = texelFetch(affinities, (first.y + s) * affinities_size.x + first.x);
  [[unroll]] for (int j = 0; j < kWindowRows; ++j) {
    [[unroll]] for (int i = 0; i < kWindowColumns; ++i) {
      const ivec2 at = clamp(first + ivec2(i, j) - 2, ivec2(0), affinities_size - 1);
      const vec4 tap = texelFetch(affinities, at.y * affinities_size.x + at.x);
      [[unroll]] for (int s = 0; s < strip; ++s) {
        if (!is_in_window(j, s)) continue;
        const vec4 d = tap - middle[s];
        const int t = s * kMostOutputs + window_tap(j, i, s);
        head[t] -= dot(d, d);
        head[kTaps + t] -= dot(d, d);
      }
    }
  }
}

/// What the albedos of each pixel's windows multiply by.
vec3 mean_divisor[strip];

/// Sets `mean_divisor`: the means of both albedos, by a softmax over the logits of `head`.
void average_divisors(ivec2 first) {
  subtract_distances(first);
  apply_softmax(2 * kTaps);
  float total[strip];
  [[unroll]] for (int s = 0; s < strip; ++s) {
    mean_divisor[s] = vec3(0.0);
    total[s] = 0.0;
  }
  [[unroll]] for (int j = 0; j < kWindowRows; ++j) {
    [[unroll]] for (int i = 0; i < kWindowColumns; ++i) {
      const ivec2 tap = clamp(first + ivec2(i, j) - 2, ivec2(0), color_size - 1);
      const int from = tap.y * color_size.x + tap.x;
      const vec3 by_albedo = divisor_of(texelFetch(albedo_depth, from).rgb);
      const vec3 by_own_albedo = albedos == 2 ? divisor_of(texelFetch(own_albedo_depth, from).rgb) : by_albedo;
      [[unroll]] for (int s = 0; s < strip; ++s) {
        if (!is_in_window(j, s)) continue;
        const int t = s * kMostOutputs + window_tap(j, i, s);
        mean_divisor[s] += head[t] * by_albedo + head[kTaps + t] * by_own_albedo;
        total[s] += head[t] + head[kTaps + t];
      }
    }
  }
  [[unroll]] for (int s = 0; s < strip; ++s) mean_divisor[s] /= total[s];
}

void write_result(ivec2 at, vec3 mean, float log_error) {
  const int index = at.y * color_size.x + at.x;
  const float exposed_to = texelFetch(exposure, 0).x;
  const vec4 own = texelFetch(color, index);
  const vec2 own_stats = texelFetch(variance, index).xy;
  const vec3 exposed = texelFetch(irradiance, at.y * affinities_size.x + at.x).rgb * mean;
  const float left = variance_of_error(log_error, dot(exposed, exposed) / 3.0) / exposed_to / exposed_to;
  smoothed.data[index] = own_stats.y > 0.0 ? vec4(exposed / exposed_to, own.a) : own;
  stats.data[index] = own_stats.y > 0.0 ? vec2(min(left, kLargestVariance), 1.0) : own_stats;
  if (has_lights != 0) divisor.data[index] = vec4(mean, 0.0);
}

void main() {
  load_head(kMostOutputs);
  const ivec2 invocation = ivec2(gl_GlobalInvocationID.xy);
  const ivec2 first = ivec2(min(invocation.x, color_size.x - 1), invocation.y * strip);
  apply_head(kMostOutputs, first, affinities_size);
  [[unroll]] for (int s = 0; s < strip; ++s) mean_divisor[s] = vec3(1.0);
  if (albedos != 0) average_divisors(first);
  [[unroll]] for (int s = 0; s < strip; ++s) {
    const ivec2 at = ivec2(invocation.x, first.y + s);
    if (at.x < color_size.x && at.y < color_size.y) {
      write_result(at, mean_divisor[s], head[s * kMostOutputs + 2 * kTaps]);
    }
  }
}
