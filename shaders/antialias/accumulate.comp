// Reads the new frame (its samples, and the pixels made of them with their variance and confidence) and the
// history at its pixels; writes their blend, which is the next history: colour, (variance, effective frames);
// the decision: (rejected share; squared bias; weight of the new frame; the new pixel's confidence, in
// frames); and if asked the rectified history. If asked, the history is rectified (survey of Yang et al.
// 2020, section 4.2); it is then weighed by one of three rules.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "lib/bilinear.glsl"
#include "lib/gain.glsl"
#include "shared/antialias_params.h"
#include "shared/limits.h"

const int kExponential = 0;
const int kGain = 1;
const int kVariance = 2;

layout(constant_id = 0) const int rule = kVariance;
layout(constant_id = 1) const int rectify = 0;
layout(constant_id = 2) const int by_deviation = 1;    // bounds of the 3x3 samples; else least and most
layout(constant_id = 3) const int masked = 0;          // averages only where patches differ
layout(constant_id = 4) const int sparse = 0;          // samples and pixels are not of one grid
layout(constant_id = 5) const int keeps_rectified = 0;
layout(constant_id = 6) const int bias_radius = 1;     // of the pixels that the bias is measured over

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Params { ivec2 size; ivec2 samples_size; ivec2 residual_size; int first_row; AccumulateParams p; };
layout(set = 0, binding = 0) uniform samplerBuffer samples;
layout(set = 0, binding = 1) uniform samplerBuffer finite;
layout(set = 0, binding = 2) uniform samplerBuffer color;
layout(set = 0, binding = 3) uniform samplerBuffer variance;
layout(set = 0, binding = 4) uniform samplerBuffer warped_color;
layout(set = 0, binding = 5) uniform samplerBuffer warped_stats;
layout(set = 0, binding = 6) uniform samplerBuffer residual;
layout(set = 0, binding = 7) uniform samplerBuffer columns;
layout(set = 0, binding = 8) uniform samplerBuffer rows;
layout(set = 0, binding = 9) uniform samplerBuffer offset;  // of the history, read where samples are sparse
layout(std430, set = 0, binding = 10) writeonly buffer MergedColorBuffer { vec4 data[]; } merged_color;
layout(std430, set = 0, binding = 11) writeonly buffer MergedStatsBuffer { vec2 data[]; } merged_stats;
layout(std430, set = 0, binding = 12) writeonly buffer DecisionBuffer { vec4 data[]; } decision;
layout(std430, set = 0, binding = 13) writeonly buffer RectifiedBuffer { vec4 data[]; } rectified;

/// Weight of a new sample of kExponential, which Philippi et al. 2022 call usual.
const float kNewest = 0.1;

#include "lib/sparse_grid.glsl"
#include "lib/history_bias.glsl"
#include "lib/samples_around.glsl"
#include "lib/alpha_around.glsl"
#include "lib/inverted_mask.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const int written = index - first_row * size.x;
  const vec4 x = texelFetch(color, index);
  const vec2 x_stats = texelFetch(variance, index).xy;
  const vec4 found = texelFetch(warped_color, index);
  const vec2 stats = texelFetch(warped_stats, index).xy;
  const bool has_sample = x_stats.y > 0.0;
  const bool has_history = stats.y > 0.0;

  vec4 h = found;
  Around around;
  const float speed_px = sparse != 0 ? length(texelFetch(offset, index).xy) : 0.0;
  if (rectify != 0 || rule == kGain) around = look_around(at, found.rgb, speed_px);
  if (rectify != 0) h.rgb = clamp(found.rgb, around.low, around.high);
  if (rectify != 0 || rule == kVariance) h.a = within_alpha_around(at, h.a);

  const float worth = has_sample ? x_stats.y : 1.0;  // of the new frame's pixel
  const float even = worth / (min(stats.y, kMostFrames - 1.0) + worth);
  float bias = 0.0;
  float alpha = sparse != 0 ? max(worth * kNewest, even) : worth * kNewest;
  if (rule == kGain) alpha = max(around.difference > 0.0 ? worth * (1.0 - around.spread / around.difference) : 0.0, even);
  if (rule == kVariance) {
    // The variance of a history of n frames is 1/n of a frame's: a tracked one would give frames that happen to
    // miss an edge, and so have no variance, all weight.
    const vec2 found_here = variance_and_bias(at, index, stats.y);
    bias = found_here.y;
    const float of_history = found_here.x / max(stats.y, kFewest);
    alpha = of_history + bias > 0.0 ? gain(divided(found_here.x, worth), of_history, bias) : even;
    alpha = max(alpha, worth / kMostFrames);
  }
  const float trusted = alpha;
  if (masked != 0) alpha = 1.0 - (1.0 - alpha) * mask_of(at);

  vec4 blended = alpha >= 1.0 ? x : h + alpha * (x - h);
  const float rest = 1.0 - alpha;
  const float old_variance = rest > 0.0 ? rest * rest * (stats.x + bias) : 0.0;
  vec2 blended_stats = vec2(min(old_variance + alpha * alpha * x_stats.x, kLargestVariance),
                            min(stats.y / (divided(alpha * alpha * stats.y, worth) + rest * rest), kMostFrames));
  vec4 decided = vec4(clamp((alpha - trusted) / max(1.0 - trusted, 1e-6), 0.0, 1.0), min(bias, kLargestVariance), alpha, worth);
  if (!has_history) {
    blended = x;
    blended_stats = vec2(x_stats.x, worth);
    decided = vec4(1.0, 0.0, 1.0, worth);
  }
  // A sample that is not finite leaves the history as it is; without history, its replacement keeps a count of 0.
  if (!has_sample) {
    blended = has_history ? found : x;
    blended_stats = stats;
    decided = vec4(0.0, 0.0, 0.0, 1.0);
  }
  merged_color.data[written] = blended;
  merged_stats.data[written] = blended_stats;
  decision.data[written] = decided;
  if (keeps_rectified != 0) rectified.data[written] = h;
}
