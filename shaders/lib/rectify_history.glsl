// The history brought within the bounds of the frame's samples. Not pure functions: the including kernel declares the
// texel buffer color and includes lib/history_bias.glsl and lib/samples_around.glsl.

float brightness_of(vec3 c) { return luminance(c.r, c.g, c.b); }

/// 1 where x lies on one of the bounds, 0 from a quarter of their distance on.
float nearness(float x, float low, float high) {
  return 1.0 - clamp(4.0 * min(x - low, high - x) / max(high - low, 1e-30), 0.0, 1.0);
}

/// Alpha has no part in what the rules compare: it stays within that of the pixels around, or black things would
/// leave opaque trails.
float within_alpha_around(ivec2 at, float alpha) {
  float least = texelFetch(color, at.y * size.x + at.x).a;
  float most = least;
  [[unroll]] for (int k = 0; k < kSide * kSide; ++k) {
    const ivec2 q = clamp(at + ivec2(k % kSide, k / kSide) - kSide / 2, ivec2(0), size - 1);
    const float a = texelFetch(color, q.y * size.x + q.x).a;
    least = min(least, a);
    most = max(most, a);
  }
  return clamp(alpha, least, most);
}

/// The history's colour within the bounds, and how near they are: 1 where it lay on one of them or beyond.
vec3 within_bounds(vec3 history, Around around, out float near_bounds) {
  near_bounds = nearness(brightness_of(history), brightness_of(around.low), brightness_of(around.high));
  return clamp(history, around.low, around.high);
}
