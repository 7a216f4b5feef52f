// How much alike the noise of neighbouring pixels is found to be.
#include "filter/input/noise_ratio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace becalm::filter {
namespace {

constexpr int kWidth = 256;
constexpr int kHeight = 144;

/// Independent noise, each sample of which is spread over [w, 1 - 2w, w] pixels along both axes, on `light`.
Frame noisy(double w, double noise, const std::function<double(int x, int y)>& light, int width = kWidth,
            int height = kHeight) {
  std::mt19937 random(1);
  std::exponential_distribution<double> skewed(1.0);
  std::vector<double> samples(static_cast<std::size_t>(width + 2) * static_cast<std::size_t>(height + 2));
  for (double& sample : samples) sample = 1.0 + noise * (skewed(random) - 1.0);
  Frame frame(1, width, height);
  Image& beauty = frame.add(Aov::beauty, 1.0f);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double sum = 0.0;
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
          const double weight = (i == 1 ? 1.0 - 2.0 * w : w) * (j == 1 ? 1.0 - 2.0 * w : w);
          const auto row = static_cast<std::size_t>(y + j) * static_cast<std::size_t>(width + 2);
          sum += weight * samples[row + static_cast<std::size_t>(x + i)];
        }
      }
      for (int c = 0; c < 3; ++c) beauty.at(x, y, c) = static_cast<float>(light(x, y) * sum);
    }
  }
  return frame;
}

double even(int /*x*/, int /*y*/) {
  return 2.0;
}

/// Waves in half of the image.
double detailed(int x, int y) {
  return x < kWidth / 2 ? 2.0 : 2.0 + std::sin(0.9 * x) * std::sin(0.7 * y);
}

TEST(NoiseRatio, IsThatOfTheSpread) {
  // From the autocorrelation of the spread's weights.
  for (const auto& [w, expected] : {std::pair(0.0, 1.0), std::pair(0.08, 1.71), std::pair(0.14, 3.22)})
    EXPECT_NEAR(noise_ratio(noisy(w, 0.5, even), {}), expected, 0.2 * expected) << w;
}

TEST(NoiseRatio, DetailCountsForNothing) {
  for (const double noise : {0.5, 0.01})
    EXPECT_LT(noise_ratio(noisy(0.0, noise, detailed), {}), 1.25) << noise;
}

TEST(NoiseRatio, DetailEverywhereCountsForLittle) {
  const auto waves = [](int x, int y) { return 2.0 + std::sin(0.9 * x) * std::sin(0.7 * y); };
  EXPECT_LT(noise_ratio(noisy(0.0, 0.16, waves), {}), 1.3);
  EXPECT_GT(noise_ratio(noisy(0.14, 0.16, waves), {}), 2.0);
}

TEST(NoiseRatio, TextureOfTheAlbedoCountsForNothing) {
  const auto texture = [](int x, int y) { return 0.5 + 0.4 * std::sin(1.5 * x) * std::sin(1.4 * y); };
  Frame frame = noisy(0.0, 0.02, texture);
  Image& albedo = frame.add(Aov::albedo);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) albedo.at(x, y, c) = static_cast<float>(texture(x, y));
    }
  }
  EXPECT_GT(noise_ratio(frame, {}), 2.0);
  EXPECT_LT(noise_ratio(frame, AovSet().set(static_cast<std::size_t>(Aov::albedo))), 1.25);
}

TEST(NoiseRatio, APowerOfTwoChangesNothing) {
  Frame frame = noisy(0.1, 0.5, even);
  const float expected = noise_ratio(frame, {});
  for (const float scale : {0x1p-90f, 0x1p90f}) {
    Frame scaled = frame;
    for (float& value : scaled.image(Aov::beauty).data()) value *= scale;
    EXPECT_EQ(noise_ratio(scaled, {}), expected) << scale;
  }
}

TEST(NoiseRatio, WithoutNoiseOrInTooFewBlocksItIsThatOfIndependentNoise) {
  EXPECT_EQ(noise_ratio(noisy(0.14, 0.0, even), {}), 1.0f);
  EXPECT_EQ(noise_ratio(noisy(0.14, 0.5, even, 112, 112), {}), 1.0f);
  EXPECT_EQ(noise_ratio(noisy(0.14, 0.5, even, 1, 1), {}), 1.0f);
  EXPECT_GT(noise_ratio(noisy(0.14, 0.5, even, 136, 136), {}), 2.0f);
}

TEST(NoiseRatio, BlocksWithNaNOrInfAreLeftOut) {
  Frame frame = noisy(0.14, 0.5, even);
  const float expected = noise_ratio(frame, {});
  for (int x = 0; x < kWidth; x += 40) {
    frame.image(Aov::beauty).at(x, 20, 1) = std::numeric_limits<float>::quiet_NaN();
    frame.image(Aov::beauty).at(x, 60, 0) = std::numeric_limits<float>::infinity();
  }
  EXPECT_NEAR(noise_ratio(frame, {}), expected, 0.1 * expected);
}

}  // namespace
}  // namespace becalm::filter
