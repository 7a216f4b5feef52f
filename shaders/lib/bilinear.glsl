// Bilinear taps of a position. A position is a pixel and the displacement from its centre. Their sum would
// round the displacement to what the pixel's coordinates leave of a float's precision, 0.001 px at 16384 px,
// and differently in every tile.

struct BilinearTaps {
  ivec2 lo;
  ivec2 hi;
  vec2 t;
};

/// Taps around a position; outside of the image its border repeats.
BilinearTaps bilinear_taps(ivec2 pixel, vec2 displacement, ivec2 size) {
  const vec2 base = floor(displacement);
  const ivec2 lo = pixel + ivec2(base);
  return BilinearTaps(clamp(lo, ivec2(0), size - 1), clamp(lo + 1, ivec2(0), size - 1), displacement - base);
}

/// The same in an image that is smaller by the factor `scale`. Its size may be rounded up. Only for a
/// power of two do results not depend on where a tile begins.
BilinearTaps bilinear_taps(ivec2 pixel, vec2 displacement, ivec2 size, float scale) {
  const vec2 coarse = floor(vec2(pixel) / scale);
  const vec2 within = vec2(pixel) - scale * coarse + displacement;
  return bilinear_taps(ivec2(coarse), (within + 0.5) / scale - 0.5, size);
}

/// The value between the taps in the first channel of an image whose rows are `width` texels, from the row
/// `first_row` of the texels on.
float bilinear_value(samplerBuffer image, BilinearTaps taps, int width, int first_row) {
  const int top = (first_row + taps.lo.y) * width;
  const int bottom = (first_row + taps.hi.y) * width;
  return mix(mix(texelFetch(image, top + taps.lo.x).x, texelFetch(image, top + taps.hi.x).x, taps.t.x),
             mix(texelFetch(image, bottom + taps.lo.x).x, texelFetch(image, bottom + taps.hi.x).x, taps.t.x), taps.t.y);
}
