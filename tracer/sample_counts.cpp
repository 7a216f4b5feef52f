#include "tracer/sample_counts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

namespace becalm::tracer {

namespace {

constexpr int kBlockPx = 16;
/// The squared error of a filtered frame over that of a pilot of as many samples: median over the shots of
/// kFilteredErrorDecay (0.36 to 2.0).
constexpr double kOfPilot = 0.5;

/// One value a block of the frame, row by row.
class Blocks {
 public:
  Blocks(int width, int height)
      : width_((width + kBlockPx - 1) / kBlockPx),
        height_((height + kBlockPx - 1) / kBlockPx),
        values_(static_cast<std::size_t>(width_) * height_, 0.0) {}

  int width() const { return width_; }
  int height() const { return height_; }
  double& at(int x, int y) { return values_[static_cast<std::size_t>(y) * width_ + x]; }
  double at(int x, int y) const { return values_[static_cast<std::size_t>(y) * width_ + x]; }
  std::vector<double>& values() { return values_; }
  const std::vector<double>& values() const { return values_; }

 private:
  int width_, height_;
  std::vector<double> values_;
};

/// Mean over the pixels of a frame; blocks at its right and lower border have fewer.
double mean_over_pixels(const Blocks& blocks, int width, int height) {
  const auto pixels = [](int block, int size) { return std::min(kBlockPx, size - block * kBlockPx); };
  double sum = 0.0;
  for (int y = 0; y < blocks.height(); ++y) {
    for (int x = 0; x < blocks.width(); ++x) sum += blocks.at(x, y) * pixels(x, width) * pixels(y, height);
  }
  return sum / (static_cast<double>(width) * height);
}

/// Means of the pilot's errors over each block and its neighbours: filters spread an error that far.
Blocks errors_of_blocks(const Image& error, int width, int height) {
  Blocks sums(width, height), counts(width, height);
  const auto block_of = [](std::int64_t pixel, int pixels_of_error, int pixels_of_frame) {
    return static_cast<int>(pixel * pixels_of_frame / pixels_of_error / kBlockPx);
  };
  for (int y = 0; y < error.height(); ++y) {
    const int row = block_of(y, error.height(), height);
    for (int x = 0; x < error.width(); ++x) {
      const int column = block_of(x, error.width(), width);
      const double value = error.at(x, y, 0);
      sums.at(column, row) += std::isfinite(value) ? std::max(value, 0.0) : 0.0;
      counts.at(column, row) += 1.0;
    }
  }
  Blocks means(width, height);
  for (int y = 0; y < means.height(); ++y) {
    for (int x = 0; x < means.width(); ++x) {
      double sum = 0.0, count = 0.0;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, means.height() - 1); ++v) {
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, means.width() - 1); ++u) {
          sum += sums.at(u, v);
          count += counts.at(u, v);
        }
      }
      means.at(x, y) = count > 0.0 ? sum / count : 0.0;
    }
  }
  return means;
}

/// Bilinear between the blocks' centres, rounded.
Image counts_of_pixels(const Blocks& blocks, int width, int height) {
  Image counts(width, height, 1);
  const auto between = [](int pixel, int count) {
    const double position = std::clamp((pixel + 0.5) / kBlockPx - 0.5, 0.0, count - 1.0);
    const int low = static_cast<int>(position);
    return std::tuple(low, std::min(low + 1, count - 1), position - low);
  };
  for (int y = 0; y < height; ++y) {
    const auto [top, bottom, down] = between(y, blocks.height());
    for (int x = 0; x < width; ++x) {
      const auto [left, right, across] = between(x, blocks.width());
      const double value =
          std::lerp(std::lerp(blocks.at(left, top), blocks.at(right, top), across),
                    std::lerp(blocks.at(left, bottom), blocks.at(right, bottom), across), down);
      counts.at(x, y, 0) = static_cast<float>(std::round(value));
    }
  }
  return counts;
}

}  // namespace

Image counts_of_mean(const Pilot& pilot, int width, int height, double mean, const SampleLimits& limits) {
  const Blocks errors = errors_of_blocks(pilot.error, width, height);
  const auto scaled = [&](double scale) {
    Blocks counts = errors;
    for (double& value : counts.values()) {
      value = std::clamp(scale * std::sqrt(value), double(limits.least), double(limits.most));
    }
    return counts;
  };
  const double largest = *std::ranges::max_element(errors.values());
  if (!(largest > 0.0)) {  // no error is known anywhere: all get the same
    Blocks even = errors;
    std::ranges::fill(even.values(), std::clamp(mean, double(limits.least), double(limits.most)));
    return counts_of_pixels(even, width, height);
  }
  double smallest = largest;
  for (const double value : errors.values()) {
    if (value > 0.0) smallest = std::min(smallest, value);
  }
  double low = limits.least / std::sqrt(largest), high = limits.most / std::sqrt(smallest);
  constexpr int steps = 60;
  for (int i = 0; i < steps; ++i) {
    const double middle = std::sqrt(low) * std::sqrt(high);
    (mean_over_pixels(scaled(middle), width, height) < mean ? low : high) = middle;
  }
  return counts_of_pixels(scaled(high), width, height);
}

Image counts_of_target(const Pilot& pilot, int width, int height, double target, const SampleLimits& limits) {
  Blocks counts = errors_of_blocks(pilot.error, width, height);
  for (double& value : counts.values()) {
    value = std::clamp(pilot.spp * std::pow(kOfPilot * value / (target * target), 1.0 / kFilteredErrorDecay),
                       double(limits.least), double(limits.most));
  }
  return counts_of_pixels(counts, width, height);
}

}  // namespace becalm::tracer
