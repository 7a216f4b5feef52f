#pragma once

#include <optional>

#include "filter/gpu/chain.h"
#include "filter/input/surface_images.h"

namespace becalm::filter {

/// A frame that came without a variance layer.
struct FrameWithoutVariance {
  gpu::ImageId color;
  gpu::ImageId valid;        ///< in the format of MergeInputs::variance; only the second value is read
  gpu::ImageId exposure;     ///< f32, 1x1
  gpu::ImageId noise_ratio;  ///< f32, 1x1: of noise_ratio.h
  /// Of frames with albedo. Without, texture can be told from noise only where it spans pixels.
  std::optional<SurfaceImages> features;
};

/// Estimates the variance from the frame alone. Returns an image in the format of MergeInputs::variance.
gpu::ImageId add_variance_estimate(gpu::Chain& chain, gpu::Extent full, const FrameWithoutVariance& frame);

}  // namespace becalm::filter
