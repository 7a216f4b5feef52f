#pragma once

#include "frame/mosaic.h"

namespace becalm::filter {

/// Fits the noise model to one mosaic: the variance of second differences of 2x2 samples of one colour, which
/// even slopes leave at 0, in the flattest of small blocks of every brightness. Saturated samples take no
/// part. Where nothing is flat, texture counts as noise. Zero if there is no block without saturated samples.
NoiseModel fit_noise(const Mosaic& mosaic, float saturated);

/// Mean squared difference of neighbouring samples of one colour beyond what noise explains: larger for
/// sharper pictures of one scene.
double sharpness(const Mosaic& mosaic, const NoiseModel& noise);

}  // namespace becalm::filter
