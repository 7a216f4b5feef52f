// The filters by which the history is read between its pixels (survey of Yang et al., section 6.1).
#include "lib/language.glsl"

// The values of filter::Resample that kernels compare with; any other is Catmull-Rom.
const int kResampleBilinear = 0;
const int kResampleSpline = 2;  // of coefficients, which merge/spline_coefficients makes

/// Catmull-Rom weights of the four taps at -1, 0, 1, 2 for a position `t` in [0,1) between taps 0 and 1. They add up to
/// one, and are (0,1,0,0) at t = 0.
void catmull_rom(float t, OUT(float) w0, OUT(float) w1, OUT(float) w2, OUT(float) w3) {
  w0 = t * (-0.5f + t * (1.0f - 0.5f * t));
  w1 = 1.0f + t * t * (-2.5f + 1.5f * t);
  w2 = t * (0.5f + t * (2.0f - 1.5f * t));
  w3 = t * t * (-0.5f + 0.5f * t);
}

/// Weights of the uniform cubic B-spline at the same taps. They add up to one.
void cubic_b_spline(float t, OUT(float) w0, OUT(float) w1, OUT(float) w2, OUT(float) w3) {
  float s = 1.0f - t;
  w0 = s * s * s / 6.0f;
  w1 = (4.0f + 3.0f * t * t * (t - 2.0f)) / 6.0f;
  w2 = (4.0f + 3.0f * s * s * (s - 2.0f)) / 6.0f;
  w3 = t * t * t / 6.0f;
}

/// Largest share in [0,1] of the sharp result in a mix with the bilinear one that keeps a channel within the
/// range of the bilinear taps. An excess of up to a millionth of the range's ends is rounding and limits
/// nothing.
float sharp_share(float sharp, float bilinear, float lowest, float highest) {
  float above = sharp - highest;
  float below = lowest - sharp;
  if (above > 1e-6f * abs(highest)) return max(highest - bilinear, 0.0f) / (sharp - bilinear);
  if (below > 1e-6f * abs(lowest)) return max(bilinear - lowest, 0.0f) / (bilinear - sharp);
  return 1.0f;
}
