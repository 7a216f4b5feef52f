#include "filter/sequence/packed_estimate.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <mutex>
#include <span>

#include "filter/for_rows.h"
#include "filter/sequence/half_values.h"
#include "filter/task.h"

namespace becalm::filter {
namespace {

constexpr float kLargestError = 0x1p-10f;
constexpr std::size_t kPixelsATask = 1 << 14;
constexpr std::size_t kBlocksATask = 1 << 11;

template <class Body>
void for_pixels(std::size_t count, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kPixelsATask),
                    [&](const tbb::blocked_range<std::size_t>& block) { body(block.begin(), block.end()); });
}

/// Calls body(begin, end) for ranges of values that begin with a block.
template <class Body>
void for_blocks(std::size_t values, const Body& body) {
  constexpr std::size_t task = kBlocksATask * kHalfBlock;
  for_each_in_parallel(static_cast<int>((values + task - 1) / task), [&](int i) {
    const std::size_t begin = static_cast<std::size_t>(i) * task;
    body(begin, std::min(begin + task, values));
  });
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
    : width_(image.width()), height_(image.height()), scale_(scale) {
  const std::span<const float> values = image.data();
  if (values.size() > std::numeric_limits<std::uint32_t>::max()) {
    floats_ = image;
    return;
  }
  const ChannelFactors factors(scale_);
  halves_.resize(values.size());
  std::mutex mutex;
  for_blocks(values.size(), [&](std::size_t begin, std::size_t end) {
    std::vector<Exception> missed;
    for (std::size_t first = begin; first < end; first += kHalfBlock) {
      const std::size_t count = std::min(kHalfBlock, end - first);
      std::array<float, kHalfBlock> block{};
      std::array<std::uint16_t, kHalfBlock> halves{};
      std::copy_n(&values[first], count, block.begin());
      std::uint32_t misses = to_halves(block.data(), factors, kLargestError, halves.data());
      std::copy_n(halves.begin(), count, &halves_[first]);
      for (; misses != 0; misses &= misses - 1) {
        const std::size_t i = first + static_cast<std::size_t>(std::countr_zero(misses));
        missed.push_back({static_cast<std::uint32_t>(i), values[i]});
      }
    }
    if (missed.empty()) return;
    const std::scoped_lock lock(mutex);
    exceptions_.insert(exceptions_.end(), missed.begin(), missed.end());
  });
  if (exceptions_.size() * sizeof(Exception) <= halves_.size() * sizeof(std::uint16_t)) return;
  floats_ = image;
  halves_ = {};
  exceptions_ = {};
}

Image HalfImage::image() const {
  if (!floats_.empty()) return floats_;
  Image image(width_, height_, static_cast<int>(scale_.size()), Unfilled());
  const ChannelFactors factors(scale_);
  const std::span<float> values = image.data();
  for_blocks(values.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t first = begin; first < end; first += kHalfBlock) {
      const std::size_t count = std::min(kHalfBlock, end - first);
      std::array<float, kHalfBlock> block{};
      std::array<std::uint16_t, kHalfBlock> halves{};
      std::copy_n(&halves_[first], count, halves.begin());
      from_halves(halves.data(), factors, block.data());
      std::copy_n(block.begin(), count, &values[first]);
    }
  });
  for (const Exception& exception : exceptions_) values[exception.index] = exception.value;
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
