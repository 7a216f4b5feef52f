// Pixel distances of the aligner: Hanika et al. 2021, eq. 2-5. `difference` is the sum over matching channels of |d|,
// or of d^2 for L2.
#include "lib/language.glsl"

const int kDistanceL2 = 0;
const int kDistanceL1 = 1;
const int kDistanceLogL1 = 2;
const int kDistanceLogL1Centered = 3;

float channel_difference(int kind, float d) { return kind == kDistanceL2 ? d * d : abs(d); }

float pixel_distance(int kind, float difference) { return kind >= kDistanceLogL1 ? log(2.0f + difference) : difference; }

/// The distance of two equal pixels.
float distance_floor(int kind) { return kind >= kDistanceLogL1 ? log(2.0f) : 0.0f; }

/// Center weight of eq. 5 for the shift s of one level; it depends on the shift alone, so that it may be applied after
/// the blur.
float center_weight(int kind, float sx, float sy) {
  return kind == kDistanceLogL1Centered ? 2.0f - exp(-0.02f * (sx * sx + sy * sy)) : 1.0f;
}
