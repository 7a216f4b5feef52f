// Where a position lies between the pixels of an image.

struct BilinearTaps {
  ivec2 lo;
  ivec2 hi;
  vec2 t;
};

/// Taps around a position, where pixel (x, y) has its centre at (x, y); outside of the image its border repeats.
BilinearTaps bilinear_taps(vec2 position, ivec2 size) {
  const vec2 base = floor(position);
  return BilinearTaps(clamp(ivec2(base), ivec2(0), size - 1), clamp(ivec2(base) + 1, ivec2(0), size - 1),
                      position - base);
}

/// The same in an image that is `scale` times smaller than the one that `position` is of; its size may be rounded up.
BilinearTaps bilinear_taps(vec2 position, ivec2 size, float scale) {
  return bilinear_taps((position + 0.5) / scale - 0.5, size);
}
