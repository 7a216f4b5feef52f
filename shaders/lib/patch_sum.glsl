// The sum over a patch without the pixel in its middle, for kernels whose patches may be 3x3 pixels. The kernel
// declares `size` and the constant `radius` before it includes this.

/// The sum over 3 pixels of the pixel's own row (`row` 0), of the one above (-1) or of the one below (1);
/// without the middle one unless `with_middle`.
vec4 sum_of_row(samplerBuffer statistics, ivec2 at, int row, bool with_middle) {
  const bool has_row = at.y + row >= 0 && at.y + row < size.y;
  const int index = (has_row ? at.y + row : at.y) * size.x + at.x;
  vec4 sum = vec4(0.0);
  [[unroll]] for (int i = -1; i <= 1; ++i) {
    if (i == 0 && !with_middle) continue;
    const bool inside = at.x + i >= 0 && at.x + i < size.x;
    const vec4 tap = texelFetch(statistics, inside ? index + i : index);
    sum += inside ? tap : vec4(0.0);
  }
  return has_row ? sum : vec4(0.0);
}

/// `sums` are those of merge/box; there are none of radius 1.
vec4 patch_without_pixel(samplerBuffer statistics, samplerBuffer sums, ivec2 at) {
  vec4 sum;
  if (radius == 1) {
    sum = sum_of_row(statistics, at, -1, true) + sum_of_row(statistics, at, 1, true) +
          sum_of_row(statistics, at, 0, false);
  } else {
    sum = texelFetch(sums, at.y * size.x + at.x);
  }
  return sum;
}
