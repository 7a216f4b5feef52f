// Bilinear read of an offset field at another resolution. Not a pure function: the including kernel declares the buffer
// `offset_coarse`.
#include "lib/bilinear.glsl"

/// Offset at the centre of pixel `at` of an image whose size is `scale` times that of the field.
vec2 read_offset(ivec2 at, ivec2 size, float scale) {
  const BilinearTaps taps = bilinear_taps(at, size, scale);
  const vec2 top = mix(offset_coarse.data[taps.lo.y * size.x + taps.lo.x], offset_coarse.data[taps.lo.y * size.x + taps.hi.x], taps.t.x);
  const vec2 bottom = mix(offset_coarse.data[taps.hi.y * size.x + taps.lo.x], offset_coarse.data[taps.hi.y * size.x + taps.hi.x], taps.t.x);
  return scale * mix(top, bottom, taps.t.y);
}
