#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "frame/image.h"

namespace becalm::judge {

/// Radiance of each pixel as the mean of independent samples, and how sure it is.
struct Estimate {
  const Image& mean;
  const Image* variance = nullptr;  ///< of the mean, as the `variance` layer has it
  double samples = 1.0;             ///< per pixel
  /// By how much a stored mean and a stored variance near 0 may be wrong: of floats 0.
  double rounding = 0.0;
  double variance_rounding = 0.0;
};

struct StatisticalOptions {
  /// Probability that a frame of unchanged expectation fails, over all its tests together.
  double false_alarm_rate = 1e-4;
  /// Relative rounding of the stored values: 2^-24 for float, 2^-11 for half. Differences that rounding alone
  /// may cause are no differences.
  double rounding = 0x1p-24;
};

/// The test of one channel of one block of pixels.
struct BlockTest {
  int x = 0;  ///< of the block's corner
  int y = 0;
  int width = 0;
  int height = 0;
  int channel = 0;
  double test_mean = 0.0;
  double reference_mean = 0.0;
  /// Difference of the means in standard deviations, corrected for skewness so that it compares with the
  /// normal distribution. Positive: the test is brighter. Infinite where neither varies and they differ.
  double z = 0.0;
  /// Probability that chance makes any of the case's tests this unusual.
  double p_value = 1.0;
};

/// All blocks of one size.
struct BlockLevel {
  int size_px = 0;  ///< edge of a block; 1: pixels; 0: the whole image
  std::size_t tests = 0;
  double threshold = 0.0;  ///< |z| above which a block of this size fails the case
  std::size_t failed = 0;
  BlockTest worst;
};

struct PixelPlace {
  int x = 0;
  int y = 0;
};

struct StatisticalResult {
  std::vector<BlockLevel> levels;  ///< by rising size, the whole image last
  std::size_t not_finite = 0;  ///< pixels with NaN or Inf in any image: left out of the tests, and a failure
  std::optional<PixelPlace> first_not_finite;

  bool passed() const;
  /// The level whose worst block is the least probable.
  const BlockLevel& worst_level() const;
};

/// Whether a frame of few samples has the expectation that the reference, a mean of many, has. Compares the
/// first three channels or the only one, of single pixels, of blocks of 2, 4, 8, ... pixels that overlap by
/// half, and of the whole image. Each size has the same share of the false-alarm rate, and so has each block
/// of a size (Sidak).
///
/// What it assumes: samples are not negative, pixels are independent (each sample counts in one pixel), and
/// neither image is filtered. What is tested is the mean: a sampler that makes other noise with the same mean
/// passes. The reference should have 16 times the samples or more, and must have a variance. Where the test
/// has none, single pixels that are too bright are taken for fireflies. Throws std::invalid_argument where
/// images have different sizes, the reference has no variance, or numbers are out of range.
StatisticalResult compare_statistically(const Estimate& test, const Estimate& reference,
                                        const StatisticalOptions& options = {});

/// One line: the worst block with its z, threshold and p-value, and what else fails.
std::string describe(const StatisticalResult& result);

}  // namespace becalm::judge
