// Bilinear read of a correction's factors, which are of blocks `scale` times as large as the including kernel's pixels. Not
// a pure function: that kernel declares the texel buffer `coarser`.
#include "lib/bilinear.glsl"

vec3 read_factor(ivec2 at, ivec2 size, float scale) {
  const BilinearTaps taps = bilinear_taps(at, vec2(0.0), size, scale);
  const int top = taps.lo.y * size.x;
  const int bottom = taps.hi.y * size.x;
  return mix(mix(texelFetch(coarser, top + taps.lo.x).rgb, texelFetch(coarser, top + taps.hi.x).rgb, taps.t.x),
             mix(texelFetch(coarser, bottom + taps.lo.x).rgb, texelFetch(coarser, bottom + taps.hi.x).rgb, taps.t.x),
             taps.t.y);
}
