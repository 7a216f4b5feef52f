#include "lib/language.glsl"

// What the network sees of a frame; scripts/train/network.py has the same.

/// Radiance, 1 where it is the frame's typical one, as the network sees it: close to the logarithm where it is bright.
float compressed_radiance(float radiance) { return 0.5f * log(1.0f + 10.0f * max(radiance, 0.0f)); }

/// The relative noise that the network is told, from the standard deviation of a pixel of this luminance.
float told_noise(float deviation, float light) { return log(1.0f + deviation / (max(light, 0.0f) + 0.1f)); }

/// The noise that the network is told where nothing is known of it.
const float kNoiseUnknown = -1.0f;

/// No finite pixel counts for less, so that windows of fireflies alone still have a mean.
const float kLeastConfidence = 1e-8f;
float confidence(float logit) { return max(1.0f / (1.0f + exp(-logit)), kLeastConfidence); }

/// A pixel that is not finite counts for this: less than any that is, but not nothing.
const float kConfidenceOfHole = 1e-20f;

/// Errors are relative to the square of exposed radiance times this, plus a floor.
const float kErrorScale = 0.3f;
const float kErrorFloor = 0.01f;

/// Variance of a pixel, in exposed units, from the network's log of its squared relative error. What is black is known to be.
float variance_of_error(float log_error, float mean_square) {
  float scale = kErrorScale * kErrorScale;
  if (mean_square == 0.0f) return 0.0f;
  return exp(clamp(log_error, -12.0f, 8.0f)) * (scale * mean_square + kErrorFloor) / scale;
}
