#include "frame/judge/statistical.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "frame/compared_pixels.h"
#include "frame/judge/block_sums.h"

namespace becalm::judge {
namespace {

/// Edge of the blocks whose median is the noise ratio.
constexpr int kNoiseBlock = 16;

double two_sided_p(double z) {
  return std::erfc(std::abs(z) / std::numbers::sqrt2);
}

/// Probability that at least one of so many independent tests has a p-value this small, and the inverse
/// (Sidak).
double p_of_any(double p, double tests) {
  return p < 1.0 ? -std::expm1(tests * std::log1p(-p)) : 1.0;
}
double p_of_each(double p, double tests) {
  return -std::expm1(std::log1p(-p) / tests);
}

void require(bool condition, const char* what) {
  if (!condition) throw std::invalid_argument(fmt::format("a statistical comparison needs {}", what));
}

/// One comparison: every block of every size.
class Comparison {
 public:
  Comparison(const Estimate& test, const Estimate& reference, const StatisticalOptions& options);
  StatisticalResult run();

 private:
  void add_level(int size_px);
  void find_not_finite();
  bool is_finite(int x, int y) const { return finite_[static_cast<std::size_t>(y) * width_ + x]; }
  Cells pixels(int c);
  /// Of the pixel's 3x3, as Sums has it.
  double local_variance(const Cells& pixels, int x, int y) const;
  /// Blocks of 2x2 cells, or of one cell, at every cell.
  void test_blocks(BlockLevel& level, const Cells& cells, int c, int cells_an_edge);
  void test_block(BlockLevel& level, const Sums& sums, const BlockTest& block);
  void complete(BlockLevel& level) const;
  double mean_of(const Image& image, const BlockTest& block) const;
  /// Variance that the test's own samples show over the one that the reference predicts: the median of
  /// blocks. 1 where nothing tells it.
  double noise_ratio() const;

  const Estimate& test_;
  const Estimate& reference_;
  const StatisticalOptions& options_;
  const int width_;
  const int height_;
  const int channels_;
  std::vector<bool> finite_;
  double noise_factor_ = 1.0;
  StatisticalResult result_;
};

Comparison::Comparison(const Estimate& test, const Estimate& reference, const StatisticalOptions& options)
    : test_(test),
      reference_(reference),
      options_(options),
      width_(test.mean.width()),
      height_(test.mean.height()),
      channels_(compared_channels(test.mean)) {
  require(reference.variance != nullptr, "the reference's variance");
  require_comparable(std::array{&test.mean, &reference.mean, reference.variance});
  if (test.variance != nullptr) require_comparable(std::array{&test.mean, test.variance});
  require(test.samples >= 1.0 && reference.samples >= 2.0, "a sample or more, and two of the reference");
  require(options.false_alarm_rate > 0.0 && options.false_alarm_rate < 1.0,
          "a false-alarm rate between 0 and 1");
  require(options.rounding >= 0.0 && options.rounding < 1.0, "a relative rounding in [0,1)");
  add_level(1);
  for (int edge = 2; edge < std::max(width_, height_); edge *= 2) add_level(edge);
  if (test.mean.pixel_count() > 1) add_level(0);
  for (BlockLevel& level : result_.levels) {
    const double rate = p_of_each(options.false_alarm_rate, static_cast<double>(result_.levels.size()));
    const double p = p_of_each(rate, static_cast<double>(level.tests));
    level.threshold = quantile(complement(boost::math::normal(), 0.5 * p));
  }
}

void Comparison::add_level(int size_px) {
  const int cell = std::max(1, size_px / 2);
  const int cells_an_edge = size_px > 1 ? 2 : 1;
  const auto blocks_along = [&](int edge) {
    return std::max(1, (edge + cell - 1) / cell - cells_an_edge + 1);
  };
  const std::size_t blocks =
      size_px == 0 ? 1 : static_cast<std::size_t>(blocks_along(width_)) * blocks_along(height_);
  result_.levels.push_back(
      {.size_px = size_px, .tests = blocks * channels_, .threshold = 0.0, .failed = 0, .worst = {}});
}

void Comparison::find_not_finite() {
  finite_.assign(test_.mean.pixel_count(), true);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      if (all_finite(std::array{&test_.mean, &reference_.mean, reference_.variance}, x, y, channels_) &&
          (test_.variance == nullptr || all_finite(std::array{test_.variance}, x, y, channels_))) {
        continue;
      }
      finite_[static_cast<std::size_t>(y) * width_ + x] = false;
      if (!result_.first_not_finite) result_.first_not_finite = PixelPlace{x, y};
      ++result_.not_finite;
    }
  }
}

double Comparison::local_variance(const Cells& pixels, int x, int y) const {
  double sum = 0.0;
  int count = 0;
  for (int v = std::max(0, y - 1); v <= std::min(height_ - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(width_ - 1, x + 1); ++u) {
      if (!is_finite(u, v)) continue;
      sum += pixels.at(u, v).shown_variance;
      ++count;
    }
  }
  return sum / count;
}

Cells Comparison::pixels(int c) {
  Cells cells{.edge_px = 1, .columns = width_, .rows = height_, .sums = {}};
  cells.sums.resize(finite_.size());
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      if (!is_finite(x, y)) continue;
      cells.at(x, y) = sums_of(test_, reference_, options_.rounding, x, y, c);
    }
  }
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      if (!is_finite(x, y)) continue;
      cells.at(x, y).local_variance = local_variance(cells, x, y);
    }
  }
  return cells;
}

void Comparison::test_blocks(BlockLevel& level, const Cells& cells, int c, int cells_an_edge) {
  const int edge = cells_an_edge * cells.edge_px;
  for (int row = 0; row < std::max(1, cells.rows - cells_an_edge + 1); ++row) {
    for (int column = 0; column < std::max(1, cells.columns - cells_an_edge + 1); ++column) {
      const int x = column * cells.edge_px;
      const int y = row * cells.edge_px;
      test_block(level, cells_an_edge == 1 ? cells.at(column, row) : cells.block(column, row),
                 {.x = x,
                  .y = y,
                  .width = std::min(edge, width_ - x),
                  .height = std::min(edge, height_ - y),
                  .channel = c});
    }
  }
}

void Comparison::test_block(BlockLevel& level, const Sums& sums, const BlockTest& block) {
  const double z = z_of(sums, noise_factor_);
  if (std::abs(z) > level.threshold) ++level.failed;
  if (level.worst.width == 0 || std::abs(z) > std::abs(level.worst.z)) {
    level.worst = block;
    level.worst.z = z;
  }
}

double Comparison::mean_of(const Image& image, const BlockTest& block) const {
  double sum = 0.0;
  std::size_t count = 0;
  for (int y = block.y; y < block.y + block.height; ++y) {
    for (int x = block.x; x < block.x + block.width; ++x) {
      if (!is_finite(x, y)) continue;
      sum += image.at(x, y, block.channel);
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN();
}

void Comparison::complete(BlockLevel& level) const {
  BlockTest& worst = level.worst;
  worst.test_mean = mean_of(test_.mean, worst);
  worst.reference_mean = mean_of(reference_.mean, worst);
  worst.p_value = p_of_any(p_of_any(two_sided_p(worst.z), static_cast<double>(level.tests)),
                           static_cast<double>(result_.levels.size()));
}

double Comparison::noise_ratio() const {
  std::vector<double> ratios;
  for (int c = 0; c < channels_ && test_.variance != nullptr; ++c) {
    for (int y = 0; y < height_; y += kNoiseBlock) {
      for (int x = 0; x < width_; x += kNoiseBlock) {
        double shown = 0.0;
        double expected = 0.0;
        for (int v = y; v < std::min(y + kNoiseBlock, height_); ++v) {
          for (int u = x; u < std::min(x + kNoiseBlock, width_); ++u) {
            if (!is_finite(u, v)) continue;
            shown += variance_at(*test_.variance, u, v, c);
            expected += variance_at(*reference_.variance, u, v, c);
          }
        }
        if (expected > 0.0) ratios.push_back(shown * test_.samples / (expected * reference_.samples));
      }
    }
  }
  if (ratios.empty()) return 1.0;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::ranges::nth_element(ratios, middle);
  return *middle;
}

StatisticalResult Comparison::run() {
  find_not_finite();
  // Noise that grew everywhere is no change of the mean; in single blocks the test's few samples tell too
  // little.
  noise_factor_ = std::max(1.0, noise_ratio());
  for (int c = 0; c < channels_; ++c) {
    Cells cells = pixels(c);
    for (BlockLevel& level : result_.levels) {
      const int cell = level.size_px > 0 ? std::max(1, level.size_px / 2) : std::max(width_, height_);
      while (cells.edge_px < cell) cells = merged(cells);
      test_blocks(level, cells, c, level.size_px > 1 ? 2 : 1);
    }
  }
  for (BlockLevel& level : result_.levels) complete(level);
  return std::move(result_);
}

std::string name_of(const BlockLevel& level) {
  const BlockTest& worst = level.worst;
  if (level.size_px == 0) return "whole image";
  if (level.size_px == 1) return fmt::format("pixel {},{}", worst.x, worst.y);
  return fmt::format("block of {}x{} pixels at {},{}", worst.width, worst.height, worst.x, worst.y);
}

}  // namespace

bool StatisticalResult::passed() const {
  return not_finite == 0 &&
         std::ranges::all_of(levels, [](const BlockLevel& level) { return level.failed == 0; });
}

const BlockLevel& StatisticalResult::worst_level() const {
  // Different levels' p-values of 0 are told apart by how far z is from its threshold.
  return *std::ranges::max_element(levels, {}, [](const BlockLevel& level) {
    return std::pair(-level.worst.p_value, std::abs(level.worst.z) / level.threshold);
  });
}

StatisticalResult compare_statistically(const Estimate& test, const Estimate& reference,
                                        const StatisticalOptions& options) {
  return Comparison(test, reference, options).run();
}

std::string describe(const StatisticalResult& result) {
  const BlockLevel& level = result.worst_level();
  const BlockTest& worst = level.worst;
  std::string text = fmt::format(
      "{}, channel {}: {:.6g} instead of {:.6g}, z {:+.2f}, threshold {:.2f}, p {}", name_of(level),
      worst.channel, worst.test_mean, worst.reference_mean, worst.z, level.threshold,
      worst.p_value > 0.0 ? fmt::format("{:.2g}", worst.p_value) : "below 1e-300");
  if (result.not_finite > 0) {
    text += fmt::format("; {} pixels are not finite, first {},{}", result.not_finite,
                        result.first_not_finite->x, result.first_not_finite->y);
  }
  return text;
}

}  // namespace becalm::judge
