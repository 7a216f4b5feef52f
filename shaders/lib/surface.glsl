// What a pixel shows, for telling whether the history showed the same: (1/depth, object id, normal as two numbers).
#include "lib/language.glsl"

/// Stands for the normal of a pixel that hits nothing.
const float kNoNormal = 2.0f;

/// Trust in history that differs by `difference`: 1 for none, 1/2 at `tolerance`.
float soft_trust(float difference, float tolerance) {
  float relative = difference / tolerance;
  return 1.0f / (1.0f + relative * relative);
}

/// Relative difference of two depths, given as inverses, beyond what the surface's slope explains: `slope` is the change
/// of the inverse depth from a pixel to the next. 0 for two pixels that hit nothing.
float depth_difference(float inverse_a, float inverse_b, float slope) {
  float larger = max(inverse_a, inverse_b);
  return larger > 0.0f ? max(abs(inverse_a - inverse_b) - slope, 0.0f) / larger : 0.0f;
}

/// Smaller of the two one-sided differences: the surface's slope, and not the step at its silhouette.
float surface_slope(float before, float here, float after) {
  return min(abs(here - before), abs(after - here));
}
