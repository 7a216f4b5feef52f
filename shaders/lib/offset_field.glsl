// Bilinear read of an offset field at another resolution. Not a pure function: the including kernel declares the texel
// buffer `offset_coarse`.
#include "lib/bilinear.glsl"

/// Offset at a position (lib/bilinear.glsl) of an image whose size is `scale` times that of the field.
vec2 read_offset(ivec2 pixel, vec2 displacement, ivec2 size, float scale) {
  const BilinearTaps taps = bilinear_taps(pixel, displacement, size, scale);
  const int top = taps.lo.y * size.x;
  const int bottom = taps.hi.y * size.x;
  return scale * mix(mix(texelFetch(offset_coarse, top + taps.lo.x).xy, texelFetch(offset_coarse, top + taps.hi.x).xy, taps.t.x),
                     mix(texelFetch(offset_coarse, bottom + taps.lo.x).xy, texelFetch(offset_coarse, bottom + taps.hi.x).xy, taps.t.x),
                     taps.t.y);
}
