// Reads the sums of one level's blocks and the factors of the coarser level; writes what is left to correct: the
// difference between the frame's mean and that of the estimate so far corrected, relative to it, and the variance that the
// frame's noise gives it: as its variance says, its half-buffers, or both on average. Blocks without pixels count nothing.
// At the finest level the sums are the images themselves.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/gain.glsl"
#include "shared/correct_params.h"

const int kVariance = 0;
const int kHalves = 1;
const int kMeanOfBoth = 2;

layout(constant_id = 0) const int noise_source = kVariance;
layout(constant_id = 1) const int of_pixels = 0;  // 1: the finest level

layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant) uniform Params { BlockParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer frame_sums;
layout(set = 0, binding = 1) uniform samplerBuffer estimate_sums;
layout(set = 0, binding = 2) uniform samplerBuffer half_sums;
layout(set = 0, binding = 3) uniform samplerBuffer variance;
layout(set = 0, binding = 4) uniform samplerBuffer estimate_stats;
layout(set = 0, binding = 5) uniform samplerBuffer coarser;
layout(set = 0, binding = 6) uniform samplerBuffer exposure;
layout(std430, set = 0, binding = 7) writeonly buffer DifferenceBuffer { vec4 data[]; } difference;
layout(std430, set = 0, binding = 8) writeonly buffer BaseBuffer { vec4 data[]; } base;

#include "lib/read_factor.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  vec4 frame = texelFetch(frame_sums, index);
  vec4 estimate = texelFetch(estimate_sums, index);
  if (of_pixels != 0) {
    const vec2 sample_stats = texelFetch(variance, index).xy;
    frame.a = sample_stats.y > 0.0 && texelFetch(estimate_stats, index).y > 0.0 ? 1.0 : 0.0;
    estimate.a = sample_stats.x;
  }
  const float pixels = max(frame.a, 1.0);
  const vec3 corrected = read_factor(at, ivec2(p.width_in, p.height_in), 2.0) * estimate.rgb / pixels;
  // In units of the frame's typical luminance, a hundredth of which is the least that differences are relative to.
  const float scale = texelFetch(exposure, 0).x;
  const vec3 d = clamp((frame.rgb / pixels - corrected) * scale, -kLargestDifference, kLargestDifference);
  float noise = estimate.a / (pixels * pixels) * scale * scale;
  if (noise_source != kVariance) {
    const vec3 e = texelFetch(half_sums, index).rgb / pixels * scale;
    const float square = dot(e, e) / 3.0;
    noise = noise_source == kHalves ? square : 0.5 * (noise + square);
  }
  noise = min(noise, kLargestDifference * kLargestDifference);
  const bool counts = frame.a > 0.0;
  difference.data[index] = counts ? vec4(d, noise) : vec4(0.0);
  base.data[index] = counts ? vec4(clamp(corrected * scale, vec3(0.0), vec3(kLargestDifference)) + 0.01, 0.0) : vec4(0.0);
}
