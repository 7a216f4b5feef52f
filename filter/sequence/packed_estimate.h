#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "filter/estimate.h"
#include "frame/pixel_memory.h"

namespace becalm::filter {

/// An image stored as half floats. Values whose relative error would exceed 2^-10 are stored as floats
/// besides; if they are many, all values are.
class HalfImage {
 public:
  HalfImage() = default;
  /// `scale` has one factor per channel, which brings typical values near 1.
  HalfImage(const Image& image, const std::vector<float>& scale);
  Image image() const;

 private:
  struct Exception {
    std::uint32_t index = 0;
    float value = 0.0f;
  };

  int width_ = 0;
  int height_ = 0;
  std::vector<float> scale_;
  std::vector<std::uint16_t, PixelAllocator<std::uint16_t>> halves_;
  std::vector<Exception> exceptions_;
  Image floats_;  ///< instead of both; usually empty
};

/// An Estimate in half the memory, within a relative 2^-10 of each value (2^-9 of variances). Additive AOVs
/// stay floats; they are scaled by the same ratio as rounding scales the radiance that they add up to.
class PackedEstimate {
 public:
  PackedEstimate() = default;
  /// `exposure` is the frame's. The last `noisy_layers` of the carried images are the noisy layers of
  /// FilterTask: 0 or FilterTask::kNoisyLayers.
  PackedEstimate(Estimate estimate, float exposure, std::size_t noisy_layers);
  Estimate estimate() const;

 private:
  HalfImage color_;
  HalfImage stats_;
  std::optional<HalfImage> noise_;
  std::vector<Image> additive_;
  std::vector<HalfImage> noisy_layers_;
};

}  // namespace becalm::filter
