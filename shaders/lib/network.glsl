#include "lib/language.glsl"

// Encodings of the network's inputs and outputs; scripts/train/network.py has the same.

/// Input for a radiance in units of the frame's typical luminance: close to the logarithm where it is bright.
float compressed_radiance(float radiance) { return 0.5f * log(1.0f + 10.0f * max(radiance, 0.0f)); }

/// Limit of the noise input, above all that training showed. The network's answer to larger inputs is
/// undefined: beside fireflies of 1e8, traces of them stayed in the frames that had merged them.
const float kLargestNoise = 10.0f;

/// Input for a pixel's noise: its standard deviation relative to its luminance, compressed.
float told_noise(float deviation, float light) {
  return min(log(1.0f + deviation / (max(light, 0.0f) + 0.1f)), kLargestNoise);
}

/// Input where the noise is not known.
const float kNoiseUnknown = -1.0f;

/// The least confidence of a finite pixel, so that windows of fireflies alone still have a mean.
const float kLeastConfidence = 1e-8f;
float confidence(float logit) { return max(1.0f / (1.0f + exp(-logit)), kLeastConfidence); }

/// The confidence of a pixel that is not finite: less than that of any finite pixel, but not 0.
const float kConfidenceOfHole = 1e-20f;

/// The relative squared error is e^2 / (x^2 + kErrorFloor), with the error e and the exposed radiance x both
/// times kErrorScale.
const float kErrorScale = 0.3f;
const float kErrorFloor = 0.01f;

/// Variance of a pixel, in exposed units, from the network's log of its squared relative error. Black pixels
/// count as exact.
float variance_of_error(float log_error, float mean_square) {
  float scale = kErrorScale * kErrorScale;
  if (mean_square == 0.0f) return 0.0f;
  return exp(clamp(log_error, -12.0f, 8.0f)) * (scale * mean_square + kErrorFloor) / scale;
}
