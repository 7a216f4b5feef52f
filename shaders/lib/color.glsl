#include "lib/language.glsl"

/// Rec.709 luminance.
float luminance(float r, float g, float b) { return 0.2126f * r + 0.7152f * g + 0.0722f * b; }

/// A radiance for matching, in units of the frame's typical luminance and limited to 16 of them, so that no
/// firefly decides the mean of its neighbours.
float exposed(float radiance, float exposure) { return min(max(radiance * exposure, 0.0f), 16.0f); }

/// Range compression of an exposed radiance to [0,1).
float compress(float x) { return x / (1.0f + x); }

/// Divisor that makes differences relative: the luminance plus a tenth of the frame's typical luminance,
/// below which errors count absolutely.
float brightness(float r, float g, float b, float exposure) {
  return max(luminance(r, g, b), 0.0f) + 0.1f / exposure;
}
