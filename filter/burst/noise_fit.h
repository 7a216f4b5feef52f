#pragma once

#include "frame/mosaic.h"

namespace becalm::filter {

/// Fits the noise model to one mosaic: the variance of second differences of 2x2 samples of one colour, which
/// even slopes leave, in the flattest of small blocks of every brightness. Saturated samples take no part. If
/// there are fewer than `kLeastBlocks` blocks, or none that is flat, the result is an upper bound: texture
/// counts as noise.
NoiseModel fit_noise(const Mosaic& mosaic, float saturated);

/// Mean squared difference of neighbouring samples of one colour beyond what noise explains: larger for
/// sharper pictures of one scene.
double sharpness(const Mosaic& mosaic, const NoiseModel& noise);

}  // namespace becalm::filter
