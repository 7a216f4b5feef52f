#pragma once

#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

#include "frame/pixel_memory.h"

namespace becalm {

/// For images whose pixels are all written next: filling them takes as long as that.
struct Unfilled {};

/// Pixels of `channels` interleaved 32-bit floats, row-major from the top left, linear and scene-referred. A
/// default-constructed image is empty.
class Image {
 public:
  Image() = default;
  Image(int width, int height, int channels, float fill = 0.0f)
      : width_(width),
        height_(height),
        channels_(channels),
        data_(static_cast<std::size_t>(width) * height * channels, fill) {
    assert(width > 0 && height > 0 && channels > 0);
  }
  Image(int width, int height, int channels, Unfilled)
      : width_(width),
        height_(height),
        channels_(channels),
        data_(static_cast<std::size_t>(width) * height * channels) {
    assert(width > 0 && height > 0 && channels > 0);
  }

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  bool empty() const { return data_.empty(); }
  std::size_t pixel_count() const { return static_cast<std::size_t>(width_) * height_; }
  bool same_shape(const Image& other) const {
    return width_ == other.width_ && height_ == other.height_ && channels_ == other.channels_;
  }

  std::span<float> data() { return data_; }
  std::span<const float> data() const { return data_; }

  /// The `channels()` floats of pixel (x, y), with 0 <= x < width() and 0 <= y < height().
  std::span<float> pixel(int x, int y) { return data().subspan(index(x, y), channels_); }
  std::span<const float> pixel(int x, int y) const { return data().subspan(index(x, y), channels_); }
  float& at(int x, int y, int channel) { return data_[index(x, y) + channel]; }
  float at(int x, int y, int channel) const { return data_[index(x, y) + channel]; }

 private:
  std::size_t index(int x, int y) const {
    assert(x >= 0 && x < width_ && y >= 0 && y < height_);
    return (static_cast<std::size_t>(y) * width_ + x) * channels_;
  }

  int width_ = 0;
  int height_ = 0;
  int channels_ = 0;
  std::vector<float, PixelAllocator<float>> data_;
};

}  // namespace becalm
