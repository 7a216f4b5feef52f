// Where a pixel lies in a smaller image.

struct BilinearTaps {
  ivec2 lo;
  ivec2 hi;
  vec2 t;
};

/// Taps around the centre of pixel `at` in an image that is `scale` times smaller; its size may be rounded up.
BilinearTaps bilinear_taps(ivec2 at, ivec2 size, float scale) {
  const vec2 position = (vec2(at) + 0.5) / scale - 0.5;
  const vec2 base = floor(position);
  return BilinearTaps(clamp(ivec2(base), ivec2(0), size - 1), clamp(ivec2(base) + 1, ivec2(0), size - 1),
                      position - base);
}
