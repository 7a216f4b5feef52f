// Reads the offsets, the new frame's albedo and the last frame's; writes the factor by which a history
// without albedo is multiplied. The factor is the last frame's albedo, read at the offsets, and changes to
// the new frame's as far as the two differ by more than noise. An albedo of few samples is noisy at edges and
// in texture, and noise that every frame multiplies in anew would never average out. If S samples fall on
// both sides of an edge, the mean squared difference of two frames is 2/S of the albedo's variance around the
// pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/reflectance.glsl"
#include "lib/resample.glsl"

/// 2/S for four samples, as the cheapest frames have them.
const float kNoiseOfVariation = 0.5;

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; ivec2 history_albedo_size; };
layout(set = 0, binding = 0) uniform samplerBuffer offset;
layout(set = 0, binding = 1) uniform samplerBuffer albedo;
layout(set = 0, binding = 2) uniform samplerBuffer history_albedo;
layout(set = 0, binding = 3) uniform samplerBuffer target_origin;
layout(std430, set = 0, binding = 4) writeonly buffer FactorBuffer { vec4 data[]; } factor;

vec3 new_at(ivec2 at) {
  const ivec2 inside = clamp(at, ivec2(0), size - 1);
  return divisor_of(texelFetch(albedo, inside.y * size.x + inside.x).rgb);
}

vec3 last_at(ivec2 at) {
  const ivec2 inside = clamp(at, ivec2(0), history_albedo_size - 1);
  return divisor_of(texelFetch(history_albedo, inside.y * history_albedo_size.x + inside.x).rgb);
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const vec2 displacement = texelFetch(offset, index).xy;
  const vec2 base = floor(displacement);
  const vec2 t = displacement - base;
  const ivec2 nearest = at + ivec2(texelFetch(target_origin, 0).xy) + ivec2(base);

  float wx[4];
  float wy[4];
  catmull_rom(t.x, wx[0], wx[1], wx[2], wx[3]);
  catmull_rom(t.y, wy[0], wy[1], wy[2], wy[3]);
  vec3 last[16];
  vec3 sharp = vec3(0.0);
  [[unroll]] for (int j = 0; j < 4; ++j) {
    [[unroll]] for (int i = 0; i < 4; ++i) {
      last[4 * j + i] = last_at(nearest + ivec2(i, j) - 1);
      sharp += wx[i] * wy[j] * last[4 * j + i];
    }
  }
  const vec3 lowest = min(min(last[5], last[6]), min(last[9], last[10]));
  const vec3 highest = max(max(last[5], last[6]), max(last[9], last[10]));

  vec3 sum = vec3(0.0);
  float sum_of_squares = 0.0;
  float difference = 0.0;
  [[unroll]] for (int j = 0; j < 3; ++j) {
    [[unroll]] for (int i = 0; i < 3; ++i) {
      const vec3 value = new_at(at + ivec2(i, j) - 1);
      const int tap = 4 * j + i;
      const vec3 before = mix(mix(last[tap], last[tap + 1], t.x), mix(last[tap + 4], last[tap + 5], t.x), t.y);
      sum += value;
      sum_of_squares += dot(value, value);
      difference += dot(value - before, value - before);
    }
  }
  const float variation = max(sum_of_squares - dot(sum, sum) / 9.0, 0.0);
  const float share = difference > 0.0 ? max(1.0 - kNoiseOfVariation * variation / difference, 0.0) : 0.0;
  factor.data[index] = vec4(mix(clamp(sharp, lowest, highest), new_at(at), share), 0.0);
}
