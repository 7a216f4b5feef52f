// Reads one scale's features and counted radiance, the coarser scale's result and, at the finest scale, the
// counted radiance of the frame itself; writes this scale's result: a weighted mean of the 5x5 window, of the
// four nearest coarser pixels and, at the finest scale, of the frame's own 3x3 pixels. The weights are a
// softmax over the network's logits, less the squared distance of affinities, times the confidence of each
// pixel of a window (Vogels et al. 2018, with one convex sum instead of two that are added and subtracted).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/dispatch_size.glsl"

layout(constant_id = 0) const int planes = 4;      // of four features each
layout(constant_id = 1) const int has_coarse = 1;  // 0: this is the coarsest scale
layout(constant_id = 2) const int has_own = 1;     // 1: this is the finest scale

layout(local_size_x = 128, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer features;
layout(set = 0, binding = 1) uniform samplerBuffer weights;
layout(set = 0, binding = 2) uniform samplerBuffer counted;
layout(set = 0, binding = 3) uniform samplerBuffer affinities;
layout(set = 0, binding = 4) uniform samplerBuffer coarse;
layout(set = 0, binding = 5) uniform samplerBuffer own_counted;
layout(std430, set = 0, binding = 6) writeonly buffer ResultBuffer { vec4 data[]; } result;

#include "lib/window.glsl"

const int kCoarseTaps = 4;
const int kOwnTaps = 9;
const int kFirstOwn = kTaps + kCoarseTaps;
const int kMostOutputs = kFirstOwn + kOwnTaps;
#include "lib/head.glsl"

/// Index of the weight of the frame's own pixel at `offset` from this one.
int own_tap(ivec2 offset) { return kFirstOwn + 3 * (offset.y + 1) + offset.x + 1; }

void main() {
  const int taps = has_own != 0 ? kMostOutputs : has_coarse != 0 ? kFirstOwn : kTaps;
  load_head(taps);
  const ivec2 at = min(ivec2(gl_GlobalInvocationID.xy), size - 1);
  const int index = at.y * size.x + at.x;
  float weight[kMostOutputs];
  apply_head(taps, index, size.x * size.y, weight);
  int tap_index[kTaps];
  const vec4 own_affinities = texelFetch(affinities, index);
  [[unroll]] for (int t = 0; t < kTaps; ++t) {
    const ivec2 tap = clamp(at + window_offset(t), ivec2(0), size - 1);
    tap_index[t] = tap.y * size.x + tap.x;
    const vec4 d = texelFetch(affinities, tap_index[t]) - own_affinities;
    weight[t] -= dot(d, d);
    const ivec2 offset = window_offset(t);
    if (has_own != 0 && max(abs(offset.x), abs(offset.y)) <= 1) weight[own_tap(offset)] -= dot(d, d);
  }
  float largest = weight[0];
  [[unroll]] for (int t = 1; t < taps; ++t) largest = max(largest, weight[t]);
  [[unroll]] for (int t = 0; t < taps; ++t) weight[t] = exp(weight[t] - largest);
  vec3 sum = vec3(0.0);
  float total = 0.0;
  [[unroll]] for (int t = 0; t < kTaps; ++t) {
    const vec4 value = texelFetch(counted, tap_index[t]);
    const float w = weight[t] * value.a;
    sum += w * value.rgb;
    total += w;
    const ivec2 offset = window_offset(t);
    if (has_own != 0 && max(abs(offset.x), abs(offset.y)) <= 1) {
      const vec4 own_value = texelFetch(own_counted, tap_index[t]);
      const float own_weight = weight[own_tap(offset)] * own_value.a;
      sum += own_weight * own_value.rgb;
      total += own_weight;
    }
  }
  if (has_coarse != 0) {
    // The coarse pixel that covers this one, the two beside it on this pixel's side, and the one across the
    // corner.
    const ivec2 own = at / 2;
    const ivec2 other = clamp(own + 2 * (at % 2) - 1, ivec2(0), size / 2 - 1);
    [[unroll]] for (int t = 0; t < kCoarseTaps; ++t) {
      const ivec2 tap = ivec2(t % 2 == 0 ? own.x : other.x, t / 2 == 0 ? own.y : other.y);
      sum += weight[kTaps + t] * texelFetch(coarse, tap.y * (size.x / 2) + tap.x).rgb;
      total += weight[kTaps + t];
    }
  }
  if (at == ivec2(gl_GlobalInvocationID.xy)) result.data[index] = vec4(sum / max(total, 1e-30), 0.0);
}
