#include "lib/language.glsl"

/// Rec.709 luminance.
float luminance(float r, float g, float b) { return 0.2126f * r + 0.7152f * g + 0.0722f * b; }

/// Range compression of a non-negative radiance for matching: exposure brings the frame's typical luminance to 1, and
/// the result lies in [0,1), so that no firefly can decide a patch.
float compress(float radiance, float exposure) {
  float x = max(radiance * exposure, 0.0f);
  // Written so that x = inf gives 1 rather than NaN.
  return 1.0f - 1.0f / (1.0f + x);
}

/// Divisor that makes differences relative: the luminance, with a floor of a tenth of the frame's typical luminance,
/// below which errors count absolutely.
float brightness(float r, float g, float b, float exposure) {
  return max(luminance(r, g, b), 0.0f) + 0.1f / exposure;
}
