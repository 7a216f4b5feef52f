#include "filter/sequence/packed_estimate.h"

#include <half.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "filter/task.h"

namespace becalm::filter {
namespace {

constexpr float kLargestError = 0x1p-10f;
constexpr std::size_t kPixelsATask = 1 << 14;

template <class Body>
void for_pixels(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kPixelsATask),
                    [&](const tbb::blocked_range<std::size_t>& block) { body(block.begin(), block.end()); });
}

/// Applies `function` to a channel: it converts variances to standard deviations, whose range is half as
/// wide, or back.
template <class Function>
void apply_to_channel(Image& image, int channel, const Function& function) {
  const std::size_t channels = static_cast<std::size_t>(image.channels());
  for_pixels(image.pixel_count(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      float& value = image.data()[i * channels + static_cast<std::size_t>(channel)];
      value = function(value);
    }
  });
}

float deviation(float variance) {
  return std::sqrt(std::max(variance, 0.0f));
}

float squared(float value) {
  return value * value;
}

/// Packs pairs of a variance and another value.
HalfImage of_variance(Image pairs, float exposure) {
  apply_to_channel(pairs, 0, deviation);
  return {pairs, {exposure, 1.0f}};
}

Image with_variance(const HalfImage& packed) {
  Image pairs = packed.image();
  apply_to_channel(pairs, 0, squared);
  return pairs;
}

/// Multiplies the colours of `image` by the ratio of `rounded` to `whole`.
void scale_as(const Image& whole, const Image& rounded, Image& image) {
  for_pixels(image.pixel_count(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = 4 * begin; i < 4 * end; ++i) {
      if (i % 4 != 3 && whole.data()[i] != 0.0f) image.data()[i] *= rounded.data()[i] / whole.data()[i];
    }
  });
}

}  // namespace

HalfImage::HalfImage(const Image& image, const std::vector<float>& scale)
    : width_(image.width()), height_(image.height()), scale_(scale), halves_(image.data().size()) {
  std::mutex mutex;
  for_pixels(image.pixel_count(), [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<std::size_t, float>> missed;
    std::size_t i = begin * scale_.size();
    for (std::size_t pixel = begin; pixel < end; ++pixel) {
      for (const float of_channel : scale_) {
        const float value = image.data()[i];
        halves_[i] = imath_float_to_half(value * of_channel);
        const float back = imath_half_to_float(halves_[i]) / of_channel;
        if (!(std::abs(back - value) <= kLargestError * std::abs(value))) missed.emplace_back(i, value);
        ++i;
      }
    }
    if (missed.empty()) return;
    const std::scoped_lock lock(mutex);
    exceptions_.insert(exceptions_.end(), missed.begin(), missed.end());
  });
}

Image HalfImage::image() const {
  Image image(width_, height_, static_cast<int>(scale_.size()), Unfilled());
  for_pixels(image.pixel_count(), [&](std::size_t begin, std::size_t end) {
    std::size_t i = begin * scale_.size();
    for (std::size_t pixel = begin; pixel < end; ++pixel) {
      for (const float of_channel : scale_) {
        image.data()[i] = imath_half_to_float(halves_[i]) / of_channel;
        ++i;
      }
    }
  });
  for (const auto& [index, value] : exceptions_) image.data()[index] = value;
  return image;
}

PackedEstimate::PackedEstimate(Estimate estimate, float exposure, std::size_t noisy_layers) {
  std::vector<Image>& images = estimate.carried;
  color_ = HalfImage(estimate.color, {exposure, exposure, exposure, 1.0f});
  stats_ = of_variance(std::move(estimate.stats), exposure);
  if (!estimate.noise.empty()) noise_ = of_variance(std::move(estimate.noise), exposure);
  const std::size_t additive = images.size() - noisy_layers;
  const std::size_t radiance = additive + FilterTask::kNoisyRadiance;
  for (std::size_t i = additive; i < images.size(); ++i) {
    const bool is_radiance = i == radiance;
    if (is_radiance) apply_to_channel(images[i], 3, deviation);
    noisy_layers_.emplace_back(images[i], std::vector<float>(4, is_radiance ? exposure : 1.0f));
  }
  if (additive == 0) return;
  const Image& whole = noisy_layers > 0 ? images[radiance] : estimate.color;
  const Image rounded = (noisy_layers > 0 ? noisy_layers_[FilterTask::kNoisyRadiance] : color_).image();
  for (std::size_t i = 0; i < additive; ++i) {
    scale_as(whole, rounded, images[i]);
    additive_.push_back(std::move(images[i]));
  }
}

Estimate PackedEstimate::estimate() const {
  Estimate estimate;
  estimate.color = color_.image();
  estimate.stats = with_variance(stats_);
  if (noise_) estimate.noise = with_variance(*noise_);
  estimate.carried = additive_;
  for (const HalfImage& layer : noisy_layers_) estimate.carried.push_back(layer.image());
  const std::size_t radiance = additive_.size() + FilterTask::kNoisyRadiance;
  if (!noisy_layers_.empty()) apply_to_channel(estimate.carried[radiance], 3, squared);
  return estimate;
}

}  // namespace becalm::filter
