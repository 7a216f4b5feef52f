#include "frame/flicker.h"

#include <array>

#include "frame/compared_pixels.h"

namespace becalm {

void Flicker::add(const Image& test, const Image& reference_a, const Image& reference_b) {
  const std::array images{&test, &reference_a, &reference_b};
  require_comparable(images);
  const int channels = compared_channels(test);
  if (frames_ == 0) {
    width_ = test.width();
    height_ = test.height();
    channels_ = channels;
    sums_.resize(test.pixel_count() * channels);
    skipped_.resize(test.pixel_count());
  }
  if (width_ != test.width() || height_ != test.height() || channels_ != channels) {
    throw std::invalid_argument("a metric was asked of frames of different sizes");
  }
  ++frames_;
  for (int y = 0; y < test.height(); ++y) {
    for (int x = 0; x < test.width(); ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * test.width() + x;
      if (!all_finite(images, x, y, channels)) {
        skipped_[pixel] = true;
        continue;
      }
      for (int c = 0; c < channels; ++c) {
        const double a = reference_a.at(x, y, c);
        const double b = reference_b.at(x, y, c);
        const double error_a = test.at(x, y, c) - a;
        const double error_b = test.at(x, y, c) - b;
        Sums& sums = sums_[pixel * channels + c];
        sums.error_a += error_a;
        sums.error_b += error_b;
        sums.product += error_a * error_b;
        sums.reference_squared += 0.25 * (a + b) * (a + b);
      }
    }
  }
}

Measured Flicker::measured() const {
  Measured result{.value = kNothingMeasured, .skipped = 0};
  if (frames_ < 2) return result;
  constexpr double floor = 0.01;  // as relMSE has it
  double total = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    if (skipped_[i / channels_]) continue;
    const Sums& sums = sums_[i];
    const double covariance = (sums.product - sums.error_a * sums.error_b / frames_) / (frames_ - 1);
    total += covariance / (sums.reference_squared / frames_ + floor);
    ++count;
  }
  for (const bool skipped : skipped_) result.skipped += skipped ? 1 : 0;
  if (count > 0) result.value = total / static_cast<double>(count);
  return result;
}

}  // namespace becalm
