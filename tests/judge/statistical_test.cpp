#include "frame/judge/statistical.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "frame/judge/block_sums.h"
#include "tests/judge/simulated.h"

namespace becalm::judge::statistical_test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Pair {
  SimulatedImage reference;
  SimulatedImage test;

  StatisticalResult compare(const StatisticalOptions& options = {}) const {
    return compare_statistically(test.estimate(), reference.estimate(), options);
  }
};

Pair simulated_pair(Noise noise, int edge_px, int samples, std::uint32_t seed = 1) {
  SampleSource source(noise, seed);
  SimulatedImage reference = simulate(source, edge_px, 16 * samples);
  return {std::move(reference), simulate(source, edge_px, samples)};
}

SimulatedImage constant(int width, int height, float value, float variance, double samples) {
  return {Image(width, height, 3, value), Image(width, height, 3, variance), samples};
}

/// Three channels whose `bright` one is the simulated image and the others are 1 with no variance.
SimulatedImage coloured(const SimulatedImage& grey, int bright) {
  SimulatedImage image = constant(grey.mean.width(), grey.mean.height(), 1.0f, 0.0f, grey.samples);
  for (int y = 0; y < grey.mean.height(); ++y) {
    for (int x = 0; x < grey.mean.width(); ++x) {
      image.mean.at(x, y, bright) = grey.mean.at(x, y, 0);
      image.variance.at(x, y, bright) = grey.variance.at(x, y, 0);
    }
  }
  return image;
}

void scale(SimulatedImage& image, float factor) {
  for (float& value : image.mean.data()) value *= factor;
  for (float& value : image.variance.data()) value *= factor * factor;
}

TEST(Statistical, FindsOtherSizesOfBlocks) {
  const StatisticalResult result = simulated_pair(Noise::gaussian, 16, 16).compare();
  std::vector<int> sizes;
  std::vector<std::size_t> tests;
  for (const BlockLevel& level : result.levels) {
    sizes.push_back(level.size_px);
    tests.push_back(level.tests);
  }
  EXPECT_EQ(sizes, (std::vector<int>{1, 2, 4, 8, 0}));
  EXPECT_EQ(tests, (std::vector<std::size_t>{256, 225, 49, 9, 1}));
  for (std::size_t i = 1; i < sizes.size(); ++i) {
    EXPECT_LT(result.levels[i].threshold, result.levels[i - 1].threshold) << sizes[i];
  }
}

/// By the definition of Sidak's correction: the rate's share of a level, then of a test, is that of a normal
/// variable beyond the threshold.
TEST(Statistical, ThresholdsShareTheRate) {
  const StatisticalResult result =
      simulated_pair(Noise::gaussian, 16, 16).compare({.false_alarm_rate = 0.01});
  double none = 1.0;
  for (const BlockLevel& level : result.levels) {
    none *= std::pow(1.0 - std::erfc(level.threshold / std::sqrt(2.0)), static_cast<double>(level.tests));
  }
  EXPECT_NEAR(1.0 - none, 0.01, 1e-9);
}

TEST(Statistical, FaintChangeOfTheWholeImageIsFoundThere) {
  Pair pair = simulated_pair(Noise::gaussian, 64, 16);
  brighten(pair.test, 0, 0, 64, 1.01);
  const StatisticalResult result = pair.compare();
  EXPECT_FALSE(result.passed());
  EXPECT_EQ(result.levels.front().failed, 0u) << "no pixel shows it";
  EXPECT_EQ(result.worst_level().size_px, 0);
  EXPECT_GT(result.worst_level().worst.z, 0.0);
  EXPECT_LT(result.worst_level().worst.p_value, 1e-4);
}

TEST(Statistical, DarkerObjectIsFoundWhereItIs) {
  Pair pair = simulated_pair(Noise::gaussian, 64, 16);
  brighten(pair.test, 41, 22, 5, 0.8);
  const StatisticalResult result = pair.compare();
  EXPECT_FALSE(result.passed());
  const BlockTest& worst = result.worst_level().worst;
  EXPECT_EQ(result.worst_level().size_px, 4);
  EXPECT_GE(worst.x, 38);
  EXPECT_LE(worst.x, 45);
  EXPECT_GE(worst.y, 19);
  EXPECT_LE(worst.y, 26);
  EXPECT_LT(worst.z, 0.0);
  EXPECT_NEAR(worst.test_mean / worst.reference_mean, 0.8, 0.05);
}

TEST(Statistical, LoneFireflyIsNoChange) {
  Pair pair = simulated_pair(Noise::gaussian, 32, 16);
  // One sample of 16 is 10,000 times as bright: the mean grows by a 16th of it, and so does its deviation.
  pair.test.mean.at(7, 9, 0) += 10000.0f / 16.0f;
  pair.test.variance.at(7, 9, 0) += std::pow(10000.0f / 16.0f, 2.0f);
  EXPECT_TRUE(pair.compare().passed()) << describe(pair.compare());
  EXPECT_TRUE(compare_statistically(pair.test.without_variance(), pair.reference.estimate()).passed());
  // Were all 16 that bright, the variance would not tell of it.
  pair.test.variance.at(7, 9, 0) = pair.reference.variance.at(7, 9, 0);
  EXPECT_FALSE(pair.compare().passed());
}

TEST(Statistical, MoreNoiseOfTheSameMeanPasses) {
  SampleSource source(Noise::lognormal, 1);
  const SimulatedImage reference = simulate(source, 32, 1024);
  SimulatedImage test = simulate(source, 32, 4);
  test.samples = 64.0;  // as if a worse sampler had used 64
  const StatisticalResult result = compare_statistically(test.estimate(), reference.estimate());
  EXPECT_TRUE(result.passed()) << describe(result);
}

/// Of the difference of two means: s^2 / n + s^2 / m, however many samples the reference has.
TEST(Statistical, TheReferencesNoiseCounts) {
  for (const double reference_samples : {16.0, 32.0, 1024.0}) {
    const SimulatedImage test = constant(1, 1, 1.0f, 0.25f / 16.0f, 16.0);
    const SimulatedImage reference =
        constant(1, 1, 1.0f, static_cast<float>(0.25 / reference_samples), reference_samples);
    const Sums sums = sums_of(test.estimate(), reference.estimate(), 0.0, 0, 0, 0);
    const double degrees = 16.0 + reference_samples;  // of freedom, one for each mean less
    EXPECT_NEAR(sums.variance,
                0.25 * (degrees - 2.0) / (degrees - 1.0) * (1.0 / 16.0 + 1.0 / reference_samples), 1e-6)
        << reference_samples;
  }
}

TEST(Statistical, ScalingBothByAPowerOfTwoChangesNothing) {
  const Pair pair = simulated_pair(Noise::lognormal, 32, 16);
  const StatisticalResult before = pair.compare();
  for (const float factor : {0x1p-30f, 0x1p-9f, 0x1p40f}) {
    Pair scaled = pair;
    scale(scaled.reference, factor);
    scale(scaled.test, factor);
    const StatisticalResult after = scaled.compare();
    for (std::size_t i = 0; i < before.levels.size(); ++i) {
      EXPECT_EQ(after.levels[i].worst.x, before.levels[i].worst.x);
      EXPECT_NEAR(after.levels[i].worst.z, before.levels[i].worst.z, 1e-5) << factor;
    }
  }
}

TEST(Statistical, SwappedChannelsSwapTheVerdict) {
  Pair pair = simulated_pair(Noise::gaussian, 32, 16);
  brighten(pair.test, 3, 4, 16, 1.2);
  for (int channel = 0; channel < 3; ++channel) {
    const SimulatedImage test = coloured(pair.test, channel);
    const SimulatedImage reference = coloured(pair.reference, channel);
    const StatisticalResult result = compare_statistically(test.estimate(), reference.estimate());
    EXPECT_FALSE(result.passed());
    EXPECT_EQ(result.worst_level().worst.channel, channel);
    EXPECT_EQ(result.worst_level().worst.z, pair.compare().worst_level().worst.z);
  }
}

TEST(Statistical, SinglePixel) {
  const SimulatedImage reference = constant(1, 1, 2.0f, 1e-4f, 1024.0);
  SimulatedImage test = constant(1, 1, 2.1f, 1e-2f, 16.0);
  const StatisticalResult result = compare_statistically(test.estimate(), reference.estimate());
  EXPECT_TRUE(result.passed());
  ASSERT_EQ(result.levels.size(), 1u);
  EXPECT_EQ(result.levels[0].tests, 3u);
  test.mean.at(0, 0, 1) = 1.0f;
  const StatisticalResult darker = compare_statistically(test.estimate(), reference.estimate());
  EXPECT_FALSE(darker.passed());
  EXPECT_EQ(darker.worst_level().worst.channel, 1);
}

TEST(Statistical, OddSizesAreCoveredToTheLastPixel) {
  for (const auto& [width, height] : {std::pair{17, 5}, {1, 33}, {2, 2}, {3, 1}}) {
    const SimulatedImage reference = constant(width, height, 1.0f, 0.0f, 1024.0);
    SimulatedImage test = constant(width, height, 1.0f, 0.0f, 16.0);
    EXPECT_TRUE(compare_statistically(test.estimate(), reference.estimate()).passed());
    test.mean.at(width - 1, height - 1, 2) = 1.001f;
    const StatisticalResult result = compare_statistically(test.estimate(), reference.estimate());
    for (const BlockLevel& level : result.levels) EXPECT_GT(level.failed, 0u) << level.size_px;
  }
}

TEST(Statistical, PixelsWithoutVarianceAreJudgedExactly) {
  for (const float value : {0.0f, 0.7f}) {
    const SimulatedImage reference = constant(8, 8, value, 0.0f, 1024.0);
    SimulatedImage test = constant(8, 8, value, 0.0f, 16.0);
    EXPECT_TRUE(compare_statistically(test.estimate(), reference.estimate()).passed());
    test.mean.at(5, 6, 0) = value + 1e-6f;
    const StatisticalResult result = compare_statistically(test.estimate(), reference.estimate());
    EXPECT_FALSE(result.passed());
    EXPECT_TRUE(std::isinf(result.worst_level().worst.z));
    EXPECT_EQ(result.worst_level().worst.x, 5);
  }
  // Rounding is no change.
  const SimulatedImage reference = constant(8, 8, 0.7f, 0.0f, 1024.0);
  const SimulatedImage test = constant(8, 8, std::nextafter(0.7f, 1.0f), 0.0f, 16.0);
  EXPECT_TRUE(compare_statistically(test.estimate(), reference.estimate()).passed());
  const SimulatedImage half = constant(8, 8, 0.7f + 0x1p-12f, 0.0f, 16.0);
  EXPECT_FALSE(compare_statistically(half.estimate(), reference.estimate()).passed());
  EXPECT_TRUE(compare_statistically(half.estimate(), reference.estimate(), {.rounding = 0x1p-11}).passed());
}

/// Half stores 3e-8 +- 2e-8 as 6e-8 without variance, of which a frame may see nothing.
TEST(Statistical, RoundingOfSmallHalvesIsNoChange) {
  constexpr float step = 0x1p-24f;
  const SimulatedImage reference = constant(8, 8, step, 0.0f, 256.0);
  SimulatedImage test = constant(8, 8, 0.0f, 0.0f, 16.0);
  EXPECT_FALSE(compare_statistically(test.estimate(), reference.estimate()).passed());
  Estimate half = reference.estimate();
  half.rounding = 0x1p-25;
  half.variance_rounding = 0x1p-50;
  test = constant(8, 8, step, 0.0f, 16.0);
  test.mean.at(3, 4, 1) = 0.0f;
  EXPECT_TRUE(compare_statistically(test.estimate(), half).passed());
  test.mean.at(3, 4, 1) = 1e-4f;
  EXPECT_FALSE(compare_statistically(test.estimate(), half).passed());
}

/// The variance of stratified samples comes from a few blocks, which by chance may all be alike.
TEST(Statistical, VarianceFarBelowTheNeighboursIsChance) {
  SimulatedImage reference = constant(8, 8, 0.01f, 1.5e-6f, 256.0);
  SimulatedImage test = constant(8, 8, 0.01f, 1e-4f, 16.0);
  for (int c = 0; c < 3; ++c) {
    reference.variance.at(4, 4, c) = 1e-8f;
    test.variance.at(4, 4, c) = 0.0f;
    test.mean.at(4, 4, c) = 0.0f;
  }
  const StatisticalResult result = compare_statistically(test.estimate(), reference.estimate());
  EXPECT_TRUE(result.passed()) << describe(result);
  std::ranges::fill(test.variance.data(), 0.0f);
  std::ranges::fill(reference.variance.data(), 1e-8f);
  EXPECT_FALSE(compare_statistically(test.estimate(), reference.estimate()).passed());
}

TEST(Statistical, LightInBlackIsFoundButOneSampleOfItIsNot) {
  const SimulatedImage reference = constant(16, 16, 0.0f, 0.0f, 1024.0);
  SimulatedImage test = constant(16, 16, 0.0f, 0.0f, 16.0);
  for (int c = 0; c < 3; ++c) {
    test.mean.at(4, 4, c) = 0.5f;
    test.variance.at(4, 4, c) = 0.25f;  // one sample of 8, the others 0
  }
  EXPECT_TRUE(compare_statistically(test.estimate(), reference.estimate()).passed());
  EXPECT_TRUE(compare_statistically(test.without_variance(), reference.estimate()).passed());
  for (int y = 4; y < 8; ++y) {
    for (int x = 4; x < 8; ++x) {
      for (int c = 0; c < 3; ++c) {
        test.mean.at(x, y, c) = 0.5f;
        test.variance.at(x, y, c) = 0.001f;
      }
    }
  }
  EXPECT_FALSE(compare_statistically(test.estimate(), reference.estimate()).passed());
  EXPECT_FALSE(compare_statistically(test.without_variance(), reference.estimate()).passed());
}

TEST(Statistical, NotFinitePixelsAreCountedAndFail) {
  for (const float bad : {kNan, std::numeric_limits<float>::infinity()}) {
    for (const bool in_test : {true, false}) {
      Pair pair = simulated_pair(Noise::gaussian, 16, 16);
      (in_test ? pair.test : pair.reference).mean.at(3, 2, 0) = bad;
      (in_test ? pair.test : pair.reference).variance.at(9, 5, 0) = bad;
      const StatisticalResult result = pair.compare();
      EXPECT_FALSE(result.passed());
      EXPECT_EQ(result.not_finite, 2u);
      ASSERT_TRUE(result.first_not_finite.has_value());
      EXPECT_EQ(result.first_not_finite->x, 3);
      EXPECT_EQ(result.first_not_finite->y, 2);
      for (const BlockLevel& level : result.levels) EXPECT_EQ(level.failed, 0u) << level.size_px;
      EXPECT_NE(describe(result).find("2 pixels are not finite, first 3,2"), std::string::npos);
    }
  }
}

TEST(Statistical, ExtremeRadianceOverflowsNothing) {
  for (const float radiance : {1e-30f, 1e30f}) {
    const SimulatedImage reference = constant(8, 8, radiance, std::min(radiance * radiance, 3e38f), 1024.0);
    const SimulatedImage test = constant(8, 8, 1.5f * radiance, std::min(radiance * radiance, 3e38f), 16.0);
    const StatisticalResult result = compare_statistically(test.estimate(), reference.estimate());
    for (const BlockLevel& level : result.levels) EXPECT_FALSE(std::isnan(level.worst.z)) << radiance;
  }
}

TEST(Statistical, RefusesWhatItCannotJudge) {
  const Pair pair = simulated_pair(Noise::gaussian, 8, 4);
  const SimulatedImage other = constant(8, 9, 1.0f, 0.0f, 4.0);
  EXPECT_THROW(compare_statistically(pair.test.estimate(), pair.reference.without_variance()),
               std::invalid_argument);
  EXPECT_THROW(compare_statistically(other.estimate(), pair.reference.estimate()), std::invalid_argument);
  for (const double rate : {0.0, 1.0, static_cast<double>(kNan)}) {
    EXPECT_THROW(pair.compare({.false_alarm_rate = rate}), std::invalid_argument) << rate;
  }
}

}  // namespace
}  // namespace becalm::judge::statistical_test
