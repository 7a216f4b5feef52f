// The end of both merge kernels: blends the new frame into the warped history with weight `alpha`; writes the
// new history and the decision: (share of the history rejected; `distrust`, which is added to the history's
// variance where it predicts this frame; weight of the new sample; 0). Not a pure function: the including
// kernel declares the buffers and the parameters. Values are selected first and written once: on a processor
// that runs lanes together, a store within a branch costs its time even where the branch is not taken.

void blend(int index, float alpha, float bias_squared, float rejected, float distrust) {
  const vec4 x = texelFetch(color, index);
  const vec2 sample_stats = texelFetch(variance, index).xy;
  const vec4 h = texelFetch(warped_color, index);
  const vec2 stats = texelFetch(warped_stats, index).xy;
  const bool has_sample = sample_stats.y > 0.0;
  const bool has_history = stats.y > 0.0;
  // The form h + alpha (x - h) keeps equal images equal bit for bit.
  vec4 merged = alpha >= 1.0 ? x : h + alpha * (x - h);
  const float merged_variance =
      alpha >= 1.0 ? sample_stats.x
                   : (1.0 - alpha) * (1.0 - alpha) * (stats.x + bias_squared) + alpha * alpha * sample_stats.x;
  vec2 merged_stats_value = vec2(min(merged_variance, kLargestVariance), blended_count(stats.y, alpha));
  vec4 decided = vec4(rejected, distrust, alpha, 0.0);
  if (!has_history) {
    merged = x;
    merged_stats_value = vec2(sample_stats.x, 1.0);
    decided = vec4(1.0, 0.0, 1.0, 0.0);
  }
  // A sample that is not finite leaves the history as it is. Without history, the pixel's replacement value
  // keeps the next match from seeing a hole; its count stays 0.
  if (!has_sample) {
    merged = has_history ? h : x;
    merged_stats_value = stats;
    decided = vec4(0.0, distrust, 0.0, 0.0);
  }
  merged_color.data[index] = merged;
  merged_stats.data[index] = merged_stats_value;
  decision.data[index] = decided;
}
