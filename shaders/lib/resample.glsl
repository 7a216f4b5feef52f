// Weights of the one-dimensional resampling filters.
#include "lib/language.glsl"

/// Catmull-Rom weights of the four taps at -1, 0, 1, 2 for a position `t` in [0,1) between taps 0 and 1. They add up to
/// one, and are (0,1,0,0) at t = 0.
void catmull_rom(float t, OUT(float) w0, OUT(float) w1, OUT(float) w2, OUT(float) w3) {
  w0 = t * (-0.5f + t * (1.0f - 0.5f * t));
  w1 = 1.0f + t * t * (-2.5f + 1.5f * t);
  w2 = t * (0.5f + t * (2.0f - 1.5f * t));
  w3 = t * t * (-0.5f + 0.5f * t);
}
