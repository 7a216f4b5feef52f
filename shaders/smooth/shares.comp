// Reads smooth/differences' outputs, their patch sums, the merged result with its expected error, that of the
// frame smoothed alone, and the weights of three small layers; writes the shares of the frame and of the frame
// smoothed alone in the output, and the squared error that is then expected. The differences are those of the
// patch without the pixel: shares that follow from the value that they weigh darken the image. Only an
// outlier, which differs more than its patch, has a smaller share of the frame. A mean's expected error is at
// most the mean of its parts' errors, and this is what is written; the frame's error is its squared difference
// from the merged result, of which it is the larger part.
// The share of the frame is that of a mix with the smoothed merged frame, into which the frame smoothed alone
// is mixed afterwards.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/color.glsl"
#include "lib/dispatch_size.glsl"
#include "lib/gain.glsl"
#include "lib/shares.glsl"

layout(constant_id = 0) const int radius = 3;

layout(local_size_x = 128, local_size_y = 1) in;
layout(set = 0, binding = 0) uniform samplerBuffer differences;
layout(set = 0, binding = 1) uniform samplerBuffer errors;
layout(set = 0, binding = 2) uniform samplerBuffer difference_sums;
layout(set = 0, binding = 3) uniform samplerBuffer error_sums;
layout(set = 0, binding = 4) uniform samplerBuffer merged_error;
layout(set = 0, binding = 5) uniform samplerBuffer alone_error;
layout(set = 0, binding = 6) uniform samplerBuffer merged;
layout(set = 0, binding = 7) uniform samplerBuffer exposure;
layout(set = 0, binding = 8) uniform samplerBuffer weights;
layout(std430, set = 0, binding = 9) writeonly buffer FrameShareBuffer { float data[]; } frame_share;
layout(std430, set = 0, binding = 10) writeonly buffer AloneShareBuffer { float data[]; } alone_share;
layout(std430, set = 0, binding = 11) writeonly buffer StatsBuffer { vec2 data[]; } stats;

#include "lib/patch_row.glsl"

// As filter/smooth/shares.h packs them: for each output of a layer its weights, four in a vector; then the
// layer's biases. Copied to shared memory and read at literal offsets (shaders/smooth/README.md says why).
const int kInputVectors = 3;  // 9 inputs
const int kHiddenVectors = 4;
const int kHidden = 4 * kHiddenVectors;
const int kFirst = 0;
const int kSecond = kFirst + kHidden * kInputVectors + kHiddenVectors;
const int kLast = kSecond + kHidden * kHiddenVectors + kHiddenVectors;
const int kOutputs = 2;
const int kVectors = kLast + kOutputs * kHiddenVectors + 1;
shared vec4 layer[kVectors];

void load_layers() {
  const int invocations = int(gl_WorkGroupSize.x * gl_WorkGroupSize.y);
  for (int i = int(gl_LocalInvocationIndex); i < kVectors; i += invocations) layer[i] = texelFetch(weights, i);
  barrier();
}

/// The logits of the shares of the frame and of the frame smoothed alone; that of the merged result is 0.
vec2 logits_of(vec4 inputs[kInputVectors]) {
  vec4 first[kHiddenVectors];
  [[unroll]] for (int o = 0; o < kHidden; ++o) {
    float sum = layer[kFirst + kHidden * kInputVectors + o / 4][o % 4];
    [[unroll]] for (int i = 0; i < kInputVectors; ++i) sum += dot(layer[kFirst + o * kInputVectors + i], inputs[i]);
    first[o / 4][o % 4] = max(sum, 0.0);
  }
  vec4 second[kHiddenVectors];
  [[unroll]] for (int o = 0; o < kHidden; ++o) {
    float sum = layer[kSecond + kHidden * kHiddenVectors + o / 4][o % 4];
    [[unroll]] for (int i = 0; i < kHiddenVectors; ++i) sum += dot(layer[kSecond + o * kHiddenVectors + i], first[i]);
    second[o / 4][o % 4] = max(sum, 0.0);
  }
  vec2 last;
  [[unroll]] for (int o = 0; o < kOutputs; ++o) {
    last[o] = layer[kLast + kOutputs * kHiddenVectors][o];
    [[unroll]] for (int i = 0; i < kHiddenVectors; ++i) last[o] += dot(layer[kLast + o * kHiddenVectors + i], second[i]);
  }
  return last;
}

void main() {
  load_layers();
  const ivec2 at = min(ivec2(gl_GlobalInvocationID.xy), size - 1);
  const int index = at.y * size.x + at.x;
  const vec4 sum = patch_without_pixel(differences, difference_sums, at);
  const float count = max(sum.w, 1.0);
  const vec3 difference = max(sum.xyz, 0.0) / count;
  const vec3 error = max(patch_without_pixel(errors, error_sums, at).xyz, 0.0) / count;
  const vec3 own_error = texelFetch(errors, index).xyz;
  const vec4 own_difference = texelFetch(differences, index);
  vec4 inputs[kInputVectors];
  inputs[0] = vec4(share_input(difference.x), share_input(difference.y), share_input(difference.z), share_input(error.x));
  inputs[1] = vec4(share_input(error.y), share_input(error.z), share_input(own_error.x), share_input(own_error.y));
  inputs[2] = vec4(share_input(own_error.z), 0.0, 0.0, 0.0);
  const vec2 logits = logits_of(inputs);
  const float largest = max(max(logits.x, logits.y), 0.0);
  const vec3 weight = exp(vec3(logits, 0.0) - largest);
  const vec3 share = weight / (weight.x + weight.y + weight.z);
  const float limit = min(kOutlier * difference.x / max(own_difference.x, 1e-12), 1.0);
  const bool valid = own_difference.w > 0.0;
  const float of_frame = valid ? limit * share.x : 0.0;
  const float of_alone = valid ? share.y : 0.0;
  const float of_merged = valid ? share.z + (1.0 - limit) * share.x : 1.0;
  const float rest = of_frame + of_merged;
  const vec2 before = texelFetch(merged_error, index).xy;
  const vec4 y = texelFetch(merged, index);
  const float bright = brightness(y.r, y.g, y.b, texelFetch(exposure, 0).x);
  const float left = of_merged * before.x + of_alone * texelFetch(alone_error, index).x +
                     of_frame * difference.x * bright * bright;
  if (at != ivec2(gl_GlobalInvocationID.xy)) return;
  frame_share.data[index] = rest > 0.0 ? of_frame / rest : 0.0;
  alone_share.data[index] = of_alone;
  stats.data[index] = vec2(min(left, kLargestVariance), before.y);
}
