// What the eyes of a pair share.
#include "lib/language.glsl"

/// By how much a depth may differ from the expected one, relative to it. Depths are means over a pixel.
const float kDepthTolerance = 0.05f;

/// Whether the depth in the other eye's image is that of the same surface. Both may be infinite, but then
/// only both: any difference is within a share of infinity.
bool is_expected_depth(float depth, float expected) {
  return depth == expected || (expected < 3.4e38f && abs(depth - expected) <= kDepthTolerance * expected);
}

/// Effective sample count of two estimates with `own` and `other` samples, blended with weight `alpha` of the
/// own one (Philippi et al., eq. 5).
float count_of_both(float own, float other, float alpha) {
  return own * other / (alpha * alpha * other + (1.0f - alpha) * (1.0f - alpha) * own);
}
