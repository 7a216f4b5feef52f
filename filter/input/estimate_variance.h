#pragma once

#include "filter/gpu/chain.h"
#include "filter/input/surface_images.h"

namespace becalm::filter {

/// Variance estimated from one frame alone, for frames that come without; returns an image as
/// MergeInputs::variance wants it. `valid` is such an image of which only the second value is read.
/// For frames with albedo:
gpu::ImageId add_variance_estimate(gpu::Chain& chain, gpu::Extent full, gpu::ImageId color,
                                   gpu::ImageId valid, const SurfaceImages& features);
/// For frames without, whose texture nothing explains:
gpu::ImageId add_variance_estimate(gpu::Chain& chain, gpu::Extent full, gpu::ImageId color,
                                   gpu::ImageId valid);

/// How far from a pixel the estimates read within the frame, in pixels.
constexpr int kVarianceEstimateMargin = 1;

}  // namespace becalm::filter
