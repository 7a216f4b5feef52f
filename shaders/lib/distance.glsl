// Pixel distances of the aligner: Hanika et al. 2021, eq. 2-5. `difference` is the sum over matching channels
// of |d|, or of d^2 for L2. Logarithms are to base 2, and the distance of equal pixels (the floor) is kept
// apart from the excess over it. A patch's sum of log(2+d) then is log 2 (n + sum of log2(1+d/2)), and that
// sum is the logarithm of a product: one logarithm instead of n.
#ifndef BECALM_DISTANCE_GLSL
#define BECALM_DISTANCE_GLSL
#include "lib/language.glsl"

const int kDistanceL2 = 0;
const int kDistanceL1 = 1;
const int kDistanceLogL1 = 2;
const int kDistanceLogL1Centered = 3;

/// The paper's distance is this times (floor + excess).
float distance_unit(int kind) { return kind >= kDistanceLogL1 ? 0.69314718f : 1.0f; }

/// The distance of two equal pixels.
float distance_floor(int kind) { return kind >= kDistanceLogL1 ? 1.0f : 0.0f; }

float channel_difference(int kind, float d) { return kind == kDistanceL2 ? d * d : abs(d); }

/// How far a pixel distance lies above the floor.
float distance_excess(int kind, float difference) {
  return kind >= kDistanceLogL1 ? log2(1.0f + 0.5f * difference) : difference;
}

/// Center weight of eq. 5 for the shift s of one level. It depends on the shift alone, so it can be applied
/// to sums over patches.
float center_weight(int kind, float sx, float sy) {
  return kind == kDistanceLogL1Centered ? 2.0f - exp(-0.02f * (sx * sx + sy * sy)) : 1.0f;
}
#endif
