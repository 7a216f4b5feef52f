#pragma once

#include "frame/metrics.h"

namespace becalm {

/// What the published tables assume: a screen of 3840 pixels and 0.7 m width, seen from 0.7 m.
inline constexpr double kFlipPixelsPerDegree = 67.0206;

/// LDR-FLIP (Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating Images"): the mean over the
/// pixels of the difference that a viewer sees who alternates between the two images, from 0 (none) to 1.
/// Linear values are clamped to [0,1] at exposure 0, as `ssim` clamps them: the display image of the paper.
/// An image of one channel is grey. Pixels that are not finite in one of the images are skipped as in the
/// other metrics; their neighbours see the reference's value there, or black, in both images.
Measured flip(const Image& test, const Image& reference, double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace becalm
