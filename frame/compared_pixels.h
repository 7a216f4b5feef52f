#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>

#include "frame/image.h"

namespace becalm {

/// The value of a metric where no pixel is finite in all images.
inline constexpr double kNothingMeasured = std::numeric_limits<double>::quiet_NaN();

/// Metrics compare the first three channels, or the only one.
inline int compared_channels(const Image& image) {
  return std::min(3, image.channels());
}

/// Throws std::invalid_argument for empty images, and for different sizes or numbers of compared channels.
template <std::size_t N>
void require_comparable(const std::array<const Image*, N>& images) {
  for (const Image* image : images) {
    if (image->empty()) throw std::invalid_argument("a metric was asked of an empty image");
    if (image->width() != images[0]->width() || image->height() != images[0]->height() ||
        compared_channels(*image) != compared_channels(*images[0])) {
      throw std::invalid_argument("a metric was asked of images of different sizes or channel counts");
    }
  }
}

/// Whether the pixel's first `channels` channels are finite in every image.
template <std::size_t N>
bool all_finite(const std::array<const Image*, N>& images, int x, int y, int channels) {
  for (const Image* image : images) {
    for (int c = 0; c < channels; ++c) {
      if (!std::isfinite(image->at(x, y, c))) return false;
    }
  }
  return true;
}

}  // namespace becalm
