// Reads smooth/difference's output, its patch sums, the estimate with its expected error, and the weights of
// three small layers; writes the share of the frame itself in the output, and the squared error that is then
// expected. The layers see the difference averaged over the patch without the pixel: a share that depends on
// the value that it weighs would darken the image. Only outliers, whose squared difference exceeds kOutlier
// times the patch's mean, get a smaller share. `fade`, if given, multiplies all shares. The error written is
// the mean of both parts' errors, weighted by their shares: an upper bound of the mix's. The frame's error is
// taken as the patch's mean squared difference from the estimate.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"
#include "shared/limits.h"

layout(constant_id = 0) const int fades = 0;

layout(local_size_x = 128, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer difference;
layout(set = 0, binding = 1) uniform samplerBuffer difference_sums;
layout(set = 0, binding = 2) uniform samplerBuffer estimate;
layout(set = 0, binding = 3) uniform samplerBuffer estimate_stats;
layout(set = 0, binding = 4) uniform samplerBuffer exposure;
layout(set = 0, binding = 5) uniform samplerBuffer weights;
layout(set = 0, binding = 6) uniform samplerBuffer fade;
layout(std430, set = 0, binding = 7) writeonly buffer ShareBuffer { float data[]; } share;
layout(std430, set = 0, binding = 8) writeonly buffer StatsBuffer { vec2 data[]; } stats;

// Of the inputs; scripts/train/own_share.py has the same.
const float kLargestInput = 1e6;
const float kLeastInput = 1e-6;
/// Squared difference, over the mean of its patch, from which a pixel of the frame counts less.
const float kOutlier = 4.0;
/// A patch's mean counts for at most this: a firefly is no less an outlier beside another.
const float kLargestPatch = 100.0;

// As filter/smooth/own_share.h packs them: for each layer its biases, then for each input the weights to all
// outputs, four outputs in a vector. Copied to shared memory and read at literal offsets
// (shaders/smooth/README.md says why).
const int kInputs = 5;
const int kHiddenVectors = 4;
const int kHidden = 4 * kHiddenVectors;
const int kSecond = (1 + kInputs) * kHiddenVectors;
const int kLast = kSecond + (1 + kHidden) * kHiddenVectors;
const int kVectors = kLast + 1 + kHidden;
shared vec4 layers[kVectors];

void load_layers() {
  const int invocations = int(gl_WorkGroupSize.x * gl_WorkGroupSize.y);
  for (int i = int(gl_LocalInvocationIndex); i < kVectors; i += invocations) layers[i] = texelFetch(weights, i);
  barrier();
}

/// Input for a squared relative difference or variance.
float encoded(float squared) { return log(min(squared, kLargestInput) + kLeastInput) / 3.0; }

/// The layer at `first`, of `values`; four outputs in a vector.
vec4[kHiddenVectors] apply_layer(int first, int inputs, int outputs, vec4 values[kHiddenVectors]) {
  vec4 sums[kHiddenVectors];
  [[unroll]] for (int o = 0; o < outputs; ++o) sums[o] = layers[first + o];
  [[unroll]] for (int i = 0; i < inputs; ++i) {
    [[unroll]] for (int o = 0; o < outputs; ++o) {
      sums[o] = fma(vec4(values[i / 4][i % 4]), layers[first + (1 + i) * outputs + o], sums[o]);
    }
  }
  return sums;
}

vec4[kHiddenVectors] rectified(vec4 values[kHiddenVectors]) {
  [[unroll]] for (int o = 0; o < kHiddenVectors; ++o) values[o] = max(values[o], 0.0);
  return values;
}

/// The share's logit.
float logit_of(vec4 inputs[kHiddenVectors]) {
  const vec4 first[kHiddenVectors] = rectified(apply_layer(0, kInputs, kHiddenVectors, inputs));
  const vec4 second[kHiddenVectors] = rectified(apply_layer(kSecond, kHidden, kHiddenVectors, first));
  return apply_layer(kLast, kHidden, 1, second)[0].x;
}

void main() {
  load_layers();
  const ivec2 at = min(ivec2(gl_GlobalInvocationID.xy), size - 1);
  const int index = at.y * size.x + at.x;
  const vec4 sum = texelFetch(difference_sums, index);
  const vec3 of_patch = max(sum.xyz, 0.0) / max(sum.w, 1.0);
  const vec4 own = texelFetch(difference, index);
  vec4 inputs[kHiddenVectors];
  inputs[0] = vec4(encoded(of_patch.x), encoded(of_patch.y), encoded(of_patch.z), encoded(own.y));
  inputs[1] = vec4(encoded(own.z), 0.0, 0.0, 0.0);
  const float limit = min(kOutlier * min(of_patch.x, kLargestPatch) / max(own.x, 1e-12), 1.0);
  const float trained = 1.0 / (1.0 + exp(-logit_of(inputs)));  // outside of branches, so not below
  const float most = fades != 0 ? texelFetch(fade, 0).x * limit : limit;
  const float of_frame = own.w > 0.0 ? most * trained : 0.0;
  const vec2 before = texelFetch(estimate_stats, index).xy;
  const vec4 y = texelFetch(estimate, index);
  const float bright = brightness(y.r, y.g, y.b, texelFetch(exposure, 0).x);
  if (at != ivec2(gl_GlobalInvocationID.xy)) return;
  share.data[index] = of_frame;
  const float left = (1.0 - of_frame) * before.x + of_frame * of_patch.x * bright * bright;
  stats.data[index] = vec2(min(left, kLargestVariance), before.y);
}
