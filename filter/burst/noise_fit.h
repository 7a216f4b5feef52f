#pragma once

#include <vector>

#include "frame/mosaic.h"

namespace becalm::filter {

/// Bound of the relative error of the variance that `fit_noise` finds.
inline constexpr double kFitError = 0.2;
/// The same of a model that a file or a user tells: sensors of one camera model differ.
inline constexpr double kToldError = 0.05;

/// Fits the noise model to one mosaic: the variance of second differences of 2x2 samples of one colour, which
/// even slopes leave at 0, in the flattest of small blocks of every brightness. Saturated samples take no
/// part. Where nothing is flat, texture counts as noise. Nothing is seen below the darkest blocks: `b` is at
/// least the share kFitError of their variance, or noise at black could be 0. Zero if there is no block
/// without saturated samples.
NoiseModel fit_noise(const Mosaic& mosaic, float saturated);

/// A block's mean, and the variance of its second differences, of which there are `count`.
struct NoiseBlock {
  double mean = 0.0;
  double variance = 0.0;
  int count = 0;
};
std::vector<NoiseBlock> noise_blocks(const Mosaic& mosaic, float saturated);
/// The same fit to blocks of any number of mosaics that have one noise.
NoiseModel fit_noise(std::vector<NoiseBlock> blocks);

/// The model of a frame at `iso_ratio` times the reference's ISO, with the least read noise that the
/// reference's allows: as ISO rises, the read noise in a sensor's numbers does not fall, and as it falls, by
/// no more than the gain. A frame whose model has less would outweigh all others at black.
NoiseModel with_least_read_noise(NoiseModel noise, const NoiseModel& reference, double iso_ratio);

/// Means over a mosaic, of neighbouring samples of one colour.
struct Contrast {
  double squared_differences = 0.0;  ///< along both axes, noise included
  double signal = 0.0;
};
Contrast contrast_of(const Mosaic& mosaic);

/// Squared differences beyond noise: larger for sharper pictures of one scene, in one exposure. Noise counts
/// as the model tells and `noise_error` more, which makes it a lower bound: in a dark frame that is scaled
/// up, a model that is too low would count as sharpness.
double sharpness(const Contrast& contrast, const NoiseModel& noise, double noise_error);

}  // namespace becalm::filter
