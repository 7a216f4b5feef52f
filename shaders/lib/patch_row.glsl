// Sums over a patch without the pixel in its middle. The kernel declares `size` and the constant `radius`
// before it includes this.

/// `sums` (merge/box) of the rows above and below the pixel, with the pixel's own row of `statistics` added, but not
/// the pixel.
vec4 patch_without_pixel(samplerBuffer statistics, samplerBuffer sums, ivec2 at) {
  const int index = at.y * size.x + at.x;
  vec4 sum = texelFetch(sums, index);
  [[unroll]] for (int i = -radius; i <= radius; ++i) {
    if (i == 0) continue;
    const bool inside = at.x + i >= 0 && at.x + i < size.x;
    const vec4 tap = texelFetch(statistics, inside ? index + i : index);
    sum += inside ? tap : vec4(0.0);
  }
  return sum;
}
