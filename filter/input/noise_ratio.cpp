#include "filter/input/noise_ratio.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "filter/for_rows.h"
#include "filter/luminance.h"

namespace becalm::filter {
namespace {

constexpr int kBlock = 16;
constexpr std::size_t kFewestBlocks = 64;
/// Pixels around a block that its differences read.
constexpr int kReach = 4;
/// Share of the blocks whose ratio stays below the one that counts, and that ratio for independent noise of
/// any strength (medians of 97 noisy frames and of their references: 0.77 and 0.82).
constexpr double kQuantile = 0.1;
constexpr double kOfIndependent = 0.8;
constexpr double kLargest = 20.0;
/// Share of the blocks, those of the least ratios, that tell detail from noise: by how much the differences
/// of taps at distance 4 are larger than those at distance 2. This is the largest such ratio of noise
/// (medians of 30 noisy frames: 1.18 of independent noise, 1.29 of it spread by [0.14, 0.72, 0.14]).
constexpr double kDetailQuantile = 0.4;
constexpr double kFartherOfNoise = 1.5;
/// What is more lowers the ratio, by this power and this factor at most: ratios of references that are all
/// detail, up to 2.4, then are below 1.5, and those of spread noise on detail, 3 and more, above 2.
constexpr double kDetailPower = 4.0;
constexpr double kMostDetail = 1.6;
/// Squared second difference, over the squared radiance, below which a block has no noise.
constexpr double kLeastNoise = 1e-10;
/// As shaders/lib/reflectance.glsl.
constexpr float kLeastDivisor = 0.04f;

/// Luminance without albedo.
Image irradiance(const Frame& frame, bool has_albedo) {
  Image result(frame.width(), frame.height(), 1, Unfilled());
  const std::span<const float> beauty = frame.image(Aov::beauty).data();
  const std::span<const float> albedo = frame.image(Aov::albedo).data();
  const std::span<float> light = result.data();
  const auto width = static_cast<std::size_t>(frame.width());
  for_rows(frame.height(), [&](int begin, int end) {
    for (std::size_t i = begin * width; i < end * width; ++i) {
      std::array<float, 3> value{};
      for (std::size_t c = 0; c < 3; ++c)
        value[c] = beauty[4 * i + c] / (has_albedo ? std::max(albedo[3 * i + c], kLeastDivisor) : 1.0f);
      light[i] = luminance(value);
    }
  });
  return result;
}

/// The squared second differences along both axes, of taps at `kDistance`, of a square of pixels, row by row.
template <int kSide, int kDistance>
std::array<double, static_cast<std::size_t>(kSide) * kSide> squared_differences(const Image& light, int x0,
                                                                                int y0) {
  constexpr int rows = kSide + 2 * kDistance;
  std::array<std::array<double, kSide>, rows> along_x;
  for (int y = 0; y < rows; ++y) {
    const float* const row = light.pixel(x0, y0 - kDistance + y).data();
    for (int x = 0; x < kSide; ++x) along_x[y][x] = row[x - kDistance] - 2.0 * row[x] + row[x + kDistance];
  }
  std::array<double, static_cast<std::size_t>(kSide) * kSide> squares;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double difference =
          along_x[y][x] - 2.0 * along_x[y + kDistance][x] + along_x[y + 2 * kDistance][x];
      squares[static_cast<std::size_t>(y) * kSide + x] = difference * difference;
    }
  }
  return squares;
}

struct Block {
  int x = 0;  ///< its first pixel
  int y = 0;
  double far = 0.0;    ///< squared differences of taps at distance 2
  double ratio = 0.0;  ///< not a number if the block has no noise, or values that are not finite
};

/// Taps at distance 1 are those of each pixel's diagonal neighbours, so that a firefly changes both sums.
Block measured_block(const Image& light, int x0, int y0) {
  constexpr std::size_t side = kBlock + 2;
  const auto near = squared_differences<kBlock + 2, 1>(light, x0 - 1, y0 - 1);
  const auto far = squared_differences<kBlock, 2>(light, x0, y0);
  double sum_near = 0.0;
  double sum_far = 0.0;
  double squares = 0.0;
  for (int y = 0; y < kBlock; ++y) {
    const float* const row = light.pixel(x0, y0 + y).data();
    for (int x = 0; x < kBlock; ++x) {
      const std::size_t first = static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x);
      sum_near += (near[first] + near[first + 2] + near[first + 2 * side] + near[first + 2 * side + 2]) / 4.0;
      sum_far += far[static_cast<std::size_t>(y) * kBlock + static_cast<std::size_t>(x)];
      const double value = row[x];
      squares += value * value;
    }
  }
  const bool has_noise = sum_near > kLeastNoise * squares;
  return {x0, y0, sum_far, has_noise ? sum_far / sum_near : std::numeric_limits<double>::quiet_NaN()};
}

/// By how much the block's differences of taps at distance 4 are larger than those at distance 2; 1 where
/// values beside the block are not finite.
double farther_ratio(const Image& light, const Block& block) {
  double sum_farther = 0.0;
  for (const double square : squared_differences<kBlock, 4>(light, block.x, block.y)) sum_farther += square;
  const double ratio = sum_farther / block.far;
  return std::isfinite(ratio) ? ratio : 1.0;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

float noise_ratio(const Frame& frame, const AovSet& used) {
  const int columns = (frame.width() - 2 * kReach) / kBlock;
  const int rows = (frame.height() - 2 * kReach) / kBlock;
  if (columns < 1 || rows < 1) return 1.0f;
  const Image light = irradiance(frame, contains(used, Aov::albedo));
  std::vector<Block> blocks(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for_each_in_parallel(static_cast<int>(blocks.size()), [&](int i) {
    blocks[static_cast<std::size_t>(i)] =
        measured_block(light, kReach + i % columns * kBlock, kReach + i / columns * kBlock);
  });
  std::erase_if(blocks, [](const Block& block) { return !std::isfinite(block.ratio); });
  if (blocks.size() < kFewestBlocks) return 1.0f;
  std::ranges::sort(blocks, {}, [](const Block& block) { return std::tuple(block.ratio, block.y, block.x); });
  const auto rank = [&](double share) {
    return static_cast<std::size_t>(share * static_cast<double>(blocks.size()));
  };
  std::vector<double> farther(rank(kDetailQuantile));
  for_each_in_parallel(static_cast<int>(farther.size()), [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    farther[at] = farther_ratio(light, blocks[at]);
  });
  const double detail =
      std::clamp(std::pow(median(std::move(farther)) / kFartherOfNoise, kDetailPower), 1.0, kMostDetail);
  return static_cast<float>(
      std::clamp(blocks[rank(kQuantile)].ratio / (kOfIndependent * detail), 1.0, kLargest));
}

}  // namespace becalm::filter
