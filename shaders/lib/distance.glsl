// The pixel distance of the aligner: Hanika et al. 2021, eq. 5, log(2+d) times the center weight, where
// `difference` d is the sum over matching channels of |d|. Logarithms are to base 2, and the distance of equal
// pixels, 1, is kept apart from the excess over it. A patch's sum of log(2+d) then is log 2 (n + sum of
// log2(1+d/2)), and that sum is the logarithm of a product: one logarithm instead of n.
#ifndef BECALM_DISTANCE_GLSL
#define BECALM_DISTANCE_GLSL
#include "lib/language.glsl"

/// The paper's distance is this times (1 + excess).
const float kDistanceUnit = 0.69314718f;

/// How far a pixel distance lies above that of equal pixels.
float distance_excess(float difference) { return log2(1.0f + 0.5f * difference); }

/// Center weight of eq. 5 for the shift s of one level. It depends on the shift alone, so it can be applied
/// to sums over patches.
float center_weight(float sx, float sy) { return 2.0f - exp(-0.02f * (sx * sx + sy * sy)); }
#endif
