// Why history lost weight: the values of the `rejected_by` AOV.
#include "lib/language.glsl"

const float kRejectedByNothing = 0.0f;
const float kRejectedByAbsence = 1.0f;   // there is none: the first frame, outside of the image, holes
const float kRejectedByResidual = 2.0f;  // patches differ by more than noise explains
const float kRejectedByDepth = 3.0f;
const float kRejectedByNormal = 4.0f;
const float kRejectedById = 5.0f;
const float kRejectedByFlow = 6.0f;  // the way there and back does not end where it began

/// The rule that took most of the history's weight, given the share that was rejected and how much the residual and the
/// distrust by `trust_rule` had to say. Less than a hundredth is nothing.
float rejection_rule(float rejected, float of_residual, float of_distrust, float trust_rule) {
  if (rejected < 0.01f) return kRejectedByNothing;
  return of_residual >= of_distrust ? kRejectedByResidual : trust_rule;
}
