#pragma once

#include "frame/frame.h"

namespace becalm::filter {

/// By how much the squared second difference of a frame's noise is larger for taps at distance 2 than for
/// taps at distance 1: 1 if the noise of pixels is independent; more, up to 20, if the renderer adds each
/// sample to several pixels, weighed by the pixel filter, instead of sampling the filter (Ernst et al. 2006,
/// "Filter importance sampling"). 1 also for frames of fewer than 64 blocks of 16x16 pixels with noise.
/// `used`: whether the radiance is divided by albedo before.
///
/// Detail raises a block's ratio as well, but not in all blocks, whereas the pixel filter is the same in all:
/// the result is the ratio that a tenth of the blocks stay below. Frames with detail in all blocks are
/// recognised by taps at distance 4: if their squared differences are more than 1.5 times those at distance
/// 2, which noise does not reach, the ratio is lowered.
float noise_ratio(const Frame& frame, const AovSet& used);

/// Ratios from which results have about twice the error of those of independent noise. Of 54 noisy frames of
/// independent noise and their 54 references none has this ratio.
constexpr float kSharedNoise = 2.0f;

}  // namespace becalm::filter
