// Reads a jittered frame and the weights of the pixel filter at the samples of the 3x3 pixels; writes the
// pixels that those samples make, and (variance of the pixel, 1; or 0 for a pixel without samples).
// All samples of a frame have one place in their pixels, so nine of them lie under a filter of radius 1.5.
// Where samples are sparser than pixels, the filter is that of the pixels, and the second value is the sum of
// its weights, the pixel's confidence (survey of Yang et al. 2020, eq. 7 to 10): 1 is a frame's worth. A wide filter
// with little weight finds samples for all pixels. Differs from the paper: the sum, not the largest weight, makes
// the mean over still frames the exact pixel filter.
// Without that place (the last of the weights is 0) a pixel is its own sample. The variance of a pixel with
// but one sample is that of the 3x3 samples (Philippi et al. 2022, eq. 10).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/limits.h"

layout(constant_id = 0) const int sparse = 0;  // 1: samples and pixels are not of one grid

layout(local_size_x = 64, local_size_y = 1) in;
layout(push_constant) uniform Sizes { ivec2 size; ivec2 samples_size; int first_row; };
layout(set = 0, binding = 0) uniform samplerBuffer samples;
layout(set = 0, binding = 1) uniform samplerBuffer finite;  // 1, or 0 for a sample that is not
layout(set = 0, binding = 2) uniform samplerBuffer weights;
layout(set = 0, binding = 3) uniform samplerBuffer columns;
layout(set = 0, binding = 4) uniform samplerBuffer rows;
layout(std430, set = 0, binding = 5) writeonly buffer ColorBuffer { vec4 data[]; } color;
layout(std430, set = 0, binding = 6) writeonly buffer VarianceBuffer { vec2 data[]; } variance;

/// Effective samples of a pixel below which their spread says little of its variance.
const float kFewSamples = 1.5;
/// Share of the wide filter in a pixel's weights.
const float kWideShare = 0.3;

#include "lib/sparse_grid.glsl"
#include "lib/squared.glsl"

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
  if (at.x >= size.x || at.y >= size.y) return;
  const int index = at.y * size.x + at.x;
  const int written = index - first_row * size.x;
  const bool known = sparse != 0 || texelFetch(weights, 9).x > 0.0;
  const GridTaps taps = grid_taps(at);
  float w[9];
  float counts[9];
  vec4 x[9];
  vec4 sum = vec4(0.0);
  float weight = 0.0;
  float squared_weights = 0.0;
  [[unroll]] for (int k = 0; k < 9; ++k) {
    const ivec2 q = taps.nearest + ivec2(k % 3, k / 3) - 1;
    const bool inside = q.x >= 0 && q.y >= 0 && q.x < samples_size.x && q.y < samples_size.y;
    const ivec2 nearest = clamp(taps.nearest, ivec2(0), samples_size - 1);
    const int tap = inside ? q.y * samples_size.x + q.x : nearest.y * samples_size.x + nearest.x;
    const bool is_sample = inside && texelFetch(finite, tap).x > 0.0;
    const float wide = taps.wide[k % 3][k / 3];
    counts[k] = is_sample ? 1.0 : 0.0;
    w[k] = counts[k] * (sparse != 0 ? taps.narrow[k % 3][k / 3] + kWideShare * wide
                        : known     ? texelFetch(weights, k).x
                        : k == 4    ? 1.0
                                    : 0.0);
    x[k] = texelFetch(samples, tap);
    sum += is_sample ? w[k] * x[k] : vec4(0.0);
    weight += w[k];
    squared_weights += w[k] * w[k];
  }
  const bool has_samples = weight > 1e-6;
  const vec4 mean = !has_samples ? x[4] : known ? sum / weight : x[4];
  float spread = 0.0;
  vec3 around = vec3(0.0);
  float squares_around = 0.0;
  float count = 0.0;
  [[unroll]] for (int k = 0; k < 9; ++k) {
    const vec3 d = limited(x[k].rgb - mean.rgb);
    spread += w[k] * dot(d, d);
    around += counts[k] * d;
    squares_around += counts[k] * dot(d, d);
    count += counts[k];
  }
  around /= max(count, 1.0);
  const float of_samples = max(squares_around / max(count, 1.0) - dot(around, around), 0.0) / 3.0;
  // The mean of n equally weighted samples has 1/n of their variance, and their spread around it is (n-1)/n.
  const float n = has_samples ? weight * weight / squared_weights : 1.0;
  const float of_pixel = n < kFewSamples ? of_samples / n : spread / (3.0 * weight * (n - 1.0));
  color.data[written] = mean;
  variance.data[written] = vec2(min(of_pixel, kLargestVariance), !has_samples ? 0.0 : sparse != 0 ? min(weight, 1.0) : 1.0);
}
