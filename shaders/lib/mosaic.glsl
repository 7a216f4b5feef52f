// Samples of a sensor's mosaic, their noise, and their weights in a merge. The table `levels` has, in this
// order: a and b of the reference's noise model, a and b of the frame's, the value from which on the
// reference's samples are saturated, the same of the frame's.
#include "lib/language.glsl"

const int kReferenceNoise = 0;
const int kFrameNoise = 2;
const int kReferenceSaturated = 4;
const int kFrameSaturated = 5;

/// Least variance, below that of any sensor's quantization.
const float kLeastVariance = 1e-12f;

/// Gaussian-Poisson noise (Foi et al. 2008): the variance of a sample of this expected value.
float noise_variance(float a, float b, float signal) {
  return max(a * max(signal, 0.0f) + b, kLeastVariance);
}

/// Anscombe's transform for that noise, with black at 0: the noise of its result has a deviation of about 1.
/// Written so that it holds for a = 0. Continues linearly below black.
float stabilized(float a, float b, float signal) {
  float c = max(0.375f * a * a + b, kLeastVariance);
  if (signal <= 0.0f) return signal / sqrt(c);
  return 2.0f * signal / (sqrt(a * signal + c) + sqrt(c));
}

/// Where samples outside of the image are read: a whole number of periods inside, at a sample of the same
/// colour.
int mirrored(int at, int size, int period) {
  if (at < 0) at += period * ((period - 1 - at) / period);
  if (at >= size) at -= period * ((at - size) / period + 1);
  return clamp(at, 0, size - 1);
}

/// Differences, in deviations of their noise, are limited to this.
const float kMostDeviations = 64.0f;
/// Mean squared difference of a patch, in variances, that noise and interpolation explain; and squared mean
/// difference times the number of samples.
const float kExplained = 1.25f;
const float kExplainedMean = 4.0f;
/// Excess over these, in variances, from which on a frame's weight falls faster than by its squared error,
/// and at which it is 0. The squared error alone would leave ghosts: where something has moved, all other
/// frames agree with each other and together outweigh the reference.
const float kDoubt = 0.5f;
const float kRejected = 4.0f;

/// Weight of a frame's sample, where the reference's own has 1: the ratio of the reference's variance to the
/// sample's expected squared error. The patch has `count` differences with this sum and sum of squares.
float frame_weight(float sum, float squares, float count, float reference_variance, float variance) {
  float mean = sum / count;
  float excess = max(squares / count - kExplained, mean * mean - kExplainedMean / count);
  float bias = max(excess, 0.0f) * (reference_variance + variance);
  float t = clamp((excess - kDoubt) / (kRejected - kDoubt), 0.0f, 1.0f);
  return reference_variance / (variance + bias) * (1.0f - t * t * (3.0f - 2.0f * t));
}
