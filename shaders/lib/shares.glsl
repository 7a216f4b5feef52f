#include "lib/language.glsl"

// Inputs of the layers that tell the shares of a result; scripts/train/shares.py has the same.

const float kLargestInput = 1e6f;
const float kLeastInput = 1e-6f;

/// Input for a squared relative difference or variance.
float share_input(float squared) { return log(min(squared, kLargestInput) + kLeastInput) / 3.0f; }

/// Squared difference, over the mean of its patch, from which a pixel of the frame counts less.
const float kOutlier = 4.0f;
