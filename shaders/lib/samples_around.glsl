// The samples around a pixel, by which its history is rectified and weighed. Not pure functions: the including
// kernel declares the texel buffers and constants that they read, and lib/sparse_grid.glsl's.

/// Where samples are sparser than pixels and the motion is kFast or more, samples with less than this share of the
/// largest weight are ignored. A smaller neighbourhood rejects more history of what moved; in still areas it would
/// flicker.
const float kNear = 0.3;
/// Pixels a frame up to which the neighbourhood is whole, and from which on it is smallest.
const float kSlow = 1.0;
const float kFast = 3.0;

/// The samples around a pixel, 3x3 or, where they are sparser than pixels, the 2x2 nearest and fewer of what moves
/// (survey, section 5.2): their bounds, and what eq. 10 and 11 take.
struct Around {
  vec3 low;
  vec3 high;
  float spread;      // eq. 10: variance of the samples
  float difference;  // eq. 11: mean squared difference between the history and a sample
};

/// `speed_px` is that of the history, in pixels a frame.
Around look_around(ivec2 at, vec3 history, float speed_px) {
  vec3 sum = vec3(0.0);
  vec3 squares = vec3(0.0);
  float difference_sum = 0.0;
  vec3 low = vec3(3.4e38);
  vec3 high = vec3(-3.4e38);
  float count = 0.0;
  // Relative to the pixel's own sample, so that the squares of an even surface cancel.
  const GridTaps taps = grid_taps(at);
  const ivec2 nearest = clamp(taps.nearest, ivec2(0), samples_size - 1);
  const int middle = nearest.y * samples_size.x + nearest.x;
  const vec3 own = texelFetch(samples, middle).rgb;
  float square_sum = 0.0;
  int tap[9];
  float weight[9];
  float most = 0.0;
  [[unroll]] for (int k = 0; k < 9; ++k) {
    const ivec2 q = taps.nearest + ivec2(k % 3, k / 3) - 1;
    const bool inside = q.x >= 0 && q.y >= 0 && q.x < samples_size.x && q.y < samples_size.y;
    tap[k] = inside ? q.y * samples_size.x + q.x : middle;
    weight[k] = inside && texelFetch(finite, tap[k]).x > 0.0 ? taps.wide[k % 3][k / 3] : 0.0;
    most = max(most, weight[k]);
  }
  const float least = sparse != 0 ? kNear * smoothstep(kSlow, kFast, speed_px) * most : 0.0;
  [[unroll]] for (int k = 0; k < 9; ++k) {
    const float w = weight[k] > least ? 1.0 : 0.0;
    const vec3 x = texelFetch(samples, tap[k]).rgb;
    const vec3 d = limited(x - own);
    sum += w * d;
    squares += w * d * d;
    low = w > 0.0 ? min(low, d) : low;
    high = w > 0.0 ? max(high, d) : high;
    square_sum += w * dot(d, d);
    difference_sum += w * squared(history - x);
    count += w;
  }
  Around around;
  const float n = max(count, 1.0);
  const vec3 mean = sum / n;
  const vec3 deviation = sqrt(max(squares / n - mean * mean, vec3(0.0)));
  around.low = by_deviation != 0 ? own + mean - deviation : own + low;
  around.high = by_deviation != 0 ? own + mean + deviation : own + high;
  if (count == 0.0) around.low = around.high = history;  // no finite sample
  around.spread = max(square_sum / n - dot(mean, mean), 0.0) / 3.0;
  around.difference = difference_sum / n;
  return around;
}
