// Sums over a patch without the pixel in its middle. The kernel declares `size` and the constant `radius`
// before it includes this.

/// Sums over the rows above and below the pixel, in the order of merge/box.
vec4 rows_beside(samplerBuffer statistics, ivec2 at) {
  vec4 sum = vec4(0.0);
  [[unroll]] for (int j = -1; j <= 1; j += 2) {
    const bool has_row = at.y + j >= 0 && at.y + j < size.y;
    const int index = (has_row ? at.y + j : at.y) * size.x + at.x;
    vec4 of_row = vec4(0.0);
    [[unroll]] for (int i = -1; i <= 1; ++i) {
      const bool inside = at.x + i >= 0 && at.x + i < size.x;
      const vec4 tap = texelFetch(statistics, inside ? index + i : index);
      of_row += inside ? tap : vec4(0.0);
    }
    sum += has_row ? of_row : vec4(0.0);
  }
  return sum;
}

/// `sums` (merge/box) of the rows above and below the pixel, with the pixel's own row of `statistics` added, but not
/// the pixel. There are no `sums` of radius 1.
vec4 patch_without_pixel(samplerBuffer statistics, samplerBuffer sums, ivec2 at) {
  const int index = at.y * size.x + at.x;
  vec4 sum;
  if (radius == 1) {
    sum = rows_beside(statistics, at);
  } else {
    sum = texelFetch(sums, index);
  }
  [[unroll]] for (int i = -radius; i <= radius; ++i) {
    if (i == 0) continue;
    const bool inside = at.x + i >= 0 && at.x + i < size.x;
    const vec4 tap = texelFetch(statistics, inside ? index + i : index);
    sum += inside ? tap : vec4(0.0);
  }
  return sum;
}
