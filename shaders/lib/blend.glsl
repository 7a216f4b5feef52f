// The end of both merge kernels: blends the new frame into the warped history with weight `alpha` and writes the new
// history and the diagnostics. Not a pure function: the including kernel declares the buffers.

void blend(int index, float alpha, float bias_squared, float max_history, float rejected) {
  const vec4 x = color.data[index];
  const vec2 sample_stats = variance.data[index];
  const vec4 h = warped_color.data[index];
  const vec2 stats = warped_stats.data[index];
  if (sample_stats.y <= 0.0) {
    // A sample that is not finite says nothing: the history goes on as it is. Where there is none, the stand-in that the
    // pixel was given keeps the next match from seeing a hole; its count stays 0.
    merged_color.data[index] = stats.y > 0.0 ? h : x;
    merged_stats.data[index] = stats;
    decision.data[index] = vec2(0.0, stats.y);
    return;
  }
  if (stats.y <= 0.0) {
    merged_color.data[index] = x;
    merged_stats.data[index] = vec2(sample_stats.x, 1.0);
    decision.data[index] = vec2(1.0, 1.0);
    return;
  }
  // Written as h + alpha (x - h), equal images stay bit for bit equal.
  merged_color.data[index] = alpha >= 1.0 ? x : h + alpha * (x - h);
  const float merged_variance =
      alpha >= 1.0 ? sample_stats.x
                   : (1.0 - alpha) * (1.0 - alpha) * (stats.x + bias_squared) + alpha * alpha * sample_stats.x;
  const float count = min(blended_count(stats.y, alpha), max_history);
  merged_stats.data[index] = vec2(min(merged_variance, kLargestVariance), count);
  decision.data[index] = vec2(rejected, count);
}
