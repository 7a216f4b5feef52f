#pragma once

#include "filter/gpu/chain.h"
#include "filter/input/surface_images.h"

namespace becalm::filter {

/// Estimates the variance from a single frame, for frames without a variance layer. Returns an image in the
/// format of MergeInputs::variance. `valid` has that format too; only its second value is read. For frames
/// with albedo:
gpu::ImageId add_variance_estimate(gpu::Chain& chain, gpu::Extent full, gpu::ImageId color,
                                   gpu::ImageId valid, const SurfaceImages& features);
/// For frames without albedo, whose texture cannot be told from noise:
gpu::ImageId add_variance_estimate(gpu::Chain& chain, gpu::Extent full, gpu::ImageId color,
                                   gpu::ImageId valid);

}  // namespace becalm::filter
