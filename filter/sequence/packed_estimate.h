#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>
#include "filter/estimate.h"

namespace becalm::filter {

/// An image as half floats, for keeping. Values that half floats miss by more than 2^-10 are kept beside
/// them.
class HalfImage {
 public:
  HalfImage() = default;
  /// `scale`, of each channel in turn, brings usual values near 1.
  HalfImage(const Image& image, const std::vector<float>& scale);
  Image image() const;

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<float> scale_;
  std::vector<std::uint16_t> halves_;
  std::vector<std::pair<std::size_t, float>> exceptions_;  ///< by index
};

/// What is known of a frame's pixels, for keeping: half the memory, within 2^-10 of each value. Additive AOVs
/// stay floats, scaled as the rounding scales the radiance that they add up to.
class PackedEstimate {
 public:
  PackedEstimate() = default;
  /// `exposure` is the frame's; the last `noisy_layers` (0 or 3) of the images carried are those of
  /// FilterTask.
  PackedEstimate(Estimate estimate, float exposure, std::size_t noisy_layers);
  Estimate estimate() const;

 private:
  HalfImage color_;
  HalfImage stats_;
  std::vector<Image> additive_;
  std::vector<HalfImage> noisy_layers_;
};

}  // namespace becalm::filter
