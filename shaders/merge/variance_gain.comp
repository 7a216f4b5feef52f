// Reads the new frame, the warped history and the patch sums of their statistics; writes the merged frame, which is the
// next frame's history. The weight of the new sample minimises the expected squared error (Philippi et al., eq. 4) with
// bias^2 estimated from patch residuals that noise does not explain. The pixel itself is left out of its patch: a Monte
// Carlo sample's variance grows with its value, so weights made from the value that they weigh would darken the image.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "lib/color.glsl"
#include "lib/gain.glsl"
#include "shared/merge_params.h"

layout(local_size_x = 8, local_size_y = 4) in;
layout(push_constant) uniform Params { VarianceGainParams p; };
layout(std430, set = 0, binding = 0) readonly buffer ColorBuffer { vec4 data[]; } color;
layout(std430, set = 0, binding = 1) readonly buffer VarianceBuffer { vec2 data[]; } variance;
layout(std430, set = 0, binding = 2) readonly buffer WarpedColorBuffer { vec4 data[]; } warped_color;
layout(std430, set = 0, binding = 3) readonly buffer WarpedStatsBuffer { vec2 data[]; } warped_stats;
layout(std430, set = 0, binding = 4) readonly buffer ExposureBuffer { float data[]; } exposure;
layout(std430, set = 0, binding = 5) readonly buffer StatisticsBuffer { vec4 data[]; } statistics;
layout(std430, set = 0, binding = 6) readonly buffer SumBuffer { vec4 data[]; } sums;
layout(std430, set = 0, binding = 7) writeonly buffer MergedColorBuffer { vec4 data[]; } merged_color;
layout(std430, set = 0, binding = 8) writeonly buffer MergedStatsBuffer { vec2 data[]; } merged_stats;
layout(std430, set = 0, binding = 9) writeonly buffer DecisionBuffer { vec2 data[]; } decision;

#include "lib/blend.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (at.x >= p.width || at.y >= p.height) return;
  const int index = at.y * p.width + at.x;
  const int plane = p.width * p.height;
  const vec4 difference = sums.data[index] - statistics.data[index];
  const vec4 noise = sums.data[plane + index] - statistics.data[plane + index];
  const float count = noise.z;
  float alpha = 1.0;
  float bias_squared = 0.0;
  float rejected = 0.0;
  if (count >= 1.0) {
    const float variance_new = max(noise.x / count, 0.0);
    const float variance_history = max(noise.y / count, 0.0);
    const float expected = variance_new + variance_history;
    // Two views of the bias: what all pixels of the patch share shows in the mean difference, whose noise averages out;
    // misaligned detail shows in the squared differences alone.
    const vec3 mean = difference.rgb / count;
    // Grey noise gives the mean's square one degree of freedom, whatever the number of channels.
    const float of_mean = excess_over_noise(dot(mean, mean) / 3.0, expected / count, 1.0, p.significance);
    const float of_pixels = excess_over_noise(max(difference.a / count, 0.0), expected, count, p.significance);
    const float relative_bias = max(of_mean, of_pixels);
    const float unbiased = max(gain(variance_new, variance_history, 0.0), 1.0 / p.max_history);
    alpha = max(gain(variance_new, variance_history, relative_bias), 1.0 / p.max_history);
    rejected = clamp(1.0 - (1.0 - alpha) / max(1.0 - unbiased, 1e-6), 0.0, 1.0);
    const vec4 h = warped_color.data[index];
    const float scale = brightness(h.r, h.g, h.b, exposure.data[0]);
    bias_squared = relative_bias * scale * scale;
  }
  blend(index, alpha, bias_squared, p.max_history, rejected);
}
