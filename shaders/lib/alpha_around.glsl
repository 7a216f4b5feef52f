// Bounds of a history's alpha. Not a pure function: the including kernel declares the texel buffer color and includes
// lib/history_bias.glsl.

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
