#include "filter/packed_estimate.h"

#include <half.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <mutex>

namespace becalm::filter {
namespace {

constexpr float kLargestError = 0x1p-10f;
constexpr std::size_t kPixelsATask = 1 << 14;

template <class Body>
void for_pixels(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kPixelsATask),
                    [&](const tbb::blocked_range<std::size_t>& block) { body(block.begin(), block.end()); });
}

/// Variances as deviations, whose range is half as wide, or back.
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

}  // namespace

HalfImage::HalfImage(const Image& image, const std::vector<float>& scale)
    : width_(image.width()), height_(image.height()), scale_(scale), halves_(image.data().size()) {
  std::mutex mutex;
  for_pixels(image.pixel_count(), [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<std::size_t, float>> missed;
    for (std::size_t i = begin * scale_.size(); i < end * scale_.size(); ++i) {
      const float value = image.data()[i];
      const float of_channel = scale_[i % scale_.size()];
      halves_[i] = imath_float_to_half(value * of_channel);
      const float back = imath_half_to_float(halves_[i]) / of_channel;
      if (!(std::abs(back - value) <= kLargestError * std::abs(value))) missed.emplace_back(i, value);
    }
    if (missed.empty()) return;
    const std::scoped_lock lock(mutex);
    exceptions_.insert(exceptions_.end(), missed.begin(), missed.end());
  });
}

Image HalfImage::image() const {
  Image image(width_, height_, static_cast<int>(scale_.size()));
  for_pixels(image.pixel_count(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * scale_.size(); i < end * scale_.size(); ++i) {
      image.data()[i] = imath_half_to_float(halves_[i]) / scale_[i % scale_.size()];
    }
  });
  for (const auto& [index, value] : exceptions_) image.data()[index] = value;
  return image;
}

PackedEstimate::PackedEstimate(Estimate estimate, float exposure, std::size_t noisy_layers)
    : noisy_layers_(noisy_layers) {
  const std::vector<float> of_radiance = {exposure, exposure, exposure, 1.0f};
  color_ = HalfImage(estimate.color, of_radiance);
  apply_to_channel(estimate.stats, 0, deviation);
  stats_ = HalfImage(estimate.stats, {exposure, 1.0f});
  const std::size_t noisy_radiance = estimate.additive.size() - noisy_layers;
  for (std::size_t i = 0; i < estimate.additive.size(); ++i) {
    if (i < noisy_radiance) {
      additive_.emplace_back(estimate.additive[i], of_radiance);
    } else if (i == noisy_radiance) {
      apply_to_channel(estimate.additive[i], 3, deviation);
      additive_.emplace_back(estimate.additive[i], std::vector<float>(4, exposure));
    } else {
      additive_.emplace_back(estimate.additive[i], std::vector<float>(4, 1.0f));
    }
  }
}

Estimate PackedEstimate::estimate() const {
  Estimate estimate;
  estimate.color = color_.image();
  estimate.stats = stats_.image();
  apply_to_channel(estimate.stats, 0, squared);
  for (const HalfImage& image : additive_) estimate.additive.push_back(image.image());
  if (noisy_layers_ > 0) apply_to_channel(estimate.additive[additive_.size() - noisy_layers_], 3, squared);
  return estimate;
}

}  // namespace becalm::filter
