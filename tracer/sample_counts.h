#pragma once

#include "frame/image.h"

namespace becalm::tracer {

/// A filtered frame's squared error falls with the samples to the power of this: neighbours and other frames
/// share samples, so that it falls less than the noise. Median over eight shots that the filter's weights are
/// chosen on (0.04 to 0.58).
inline constexpr double kFilteredErrorDecay = 0.45;

/// What a pilot, a cheap render of a frame, tells about where the frame needs samples.
struct Pilot {
  Image error;       ///< one channel, of any size: expected squared error relative to the squared brightness
  double spp = 1.0;  ///< samples that the error belongs to, per pixel of the frame
};

/// Of a pixel.
inline constexpr int kMostSamples = 65536;

/// Limits of the samples of a pixel, both from 1 to kMostSamples.
struct SampleLimits {
  int least = 1;
  int most = kMostSamples;
};

/// Samples of each pixel, as RenderOptions::sample_counts: `mean` on average, more where the pilot expects a
/// larger error. Counts change smoothly between blocks of 16 pixels. The samples that minimise the sum of
/// errors e / n are n ~ sqrt(e). Errors that are negative or not finite count as 0.
Image counts_of_mean(const Pilot& pilot, int width, int height, double mean, const SampleLimits& limits);

/// Samples of each pixel so that the expected error of every block comes down to `target`: a relative
/// deviation, the root of the squared error.
Image counts_of_target(const Pilot& pilot, int width, int height, double target, const SampleLimits& limits);

}  // namespace becalm::tracer
