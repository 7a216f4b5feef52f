// Which alpha counts as noise and which is passed on unchanged.
#include "filter/sequence/alpha.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace becalm::filter {
namespace {

constexpr int kSize = 64;

Image with_alpha(const std::function<float(int, int)>& alpha) {
  Image beauty(kSize, kSize, 4, 0.5f);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) beauty.at(x, y, 3) = alpha(x, y);
  }
  return beauty;
}

std::ptrdiff_t count_noisy(const Image& beauty) {
  return std::ranges::count(noisy_alpha(beauty), 1);
}

/// Coverage at an edge that the pixel filter blurs to `width_px`.
float covered(float distance_px, float width_px) {
  return std::clamp(0.5f - distance_px / width_px, 0.0f, 1.0f);
}

/// A strip between two soft edges, sampled `samples` times.
Image blurred(int samples) {
  std::mt19937 random(3);
  return with_alpha([&](int x, int) {
    const float truth = covered(static_cast<float>(x) - 32.0f, 40.0f);
    return static_cast<float>(std::binomial_distribution<int>(samples, truth)(random)) / samples;
  });
}

TEST(NoisyAlpha, CleanMattesAreNot) {
  for (const float level : {0.0f, 0.5f, 1.0f}) {
    EXPECT_EQ(count_noisy(with_alpha([&](int, int) { return level; })), 0) << level;
  }
  for (const float width : {1.0f, 3.0f, 30.0f}) {
    const auto disc = [&](int x, int y) { return covered(std::hypot(x - 30.3f, y - 33.1f) - 20.2f, width); };
    EXPECT_EQ(count_noisy(with_alpha(disc)), 0) << width;
  }
  EXPECT_EQ(count_noisy(with_alpha([](int x, int y) { return static_cast<float>((x + y) % 2); })), 0);
  const auto stars = [](int x, int y) { return x % 11 == 5 && y % 11 == 5 ? 1.0f : 0.0f; };
  EXPECT_EQ(count_noisy(with_alpha(stars)), 0);
}

TEST(NoisyAlpha, ThinLinesInAnyDirectionAreNot) {
  for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}, {1, 1}, {1, -1}}) {
    const auto lines = [&](int x, int y) { return (dy * x - dx * y + 7 * kSize) % 7 == 0 ? 1.0f : 0.0f; };
    EXPECT_EQ(count_noisy(with_alpha(lines)), 0) << dx << "," << dy;
  }
}

TEST(NoisyAlpha, BlurOfFewSamplesIs) {
  for (const int samples : {4, 8, 16}) {
    const Image beauty = blurred(samples);
    const std::vector<std::uint8_t> noisy = noisy_alpha(beauty);
    std::ptrdiff_t inside = 0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 20; x < 44; ++x) inside += noisy[static_cast<std::size_t>(y) * kSize + x];
      EXPECT_EQ(noisy[static_cast<std::size_t>(y) * kSize], 0) << "1 among ones";
    }
    EXPECT_GT(inside, 24 * kSize * 9 / 10) << samples;
  }
}

TEST(NoisyAlpha, NothingButIsReplacedAndWithinBounds) {
  const Image beauty = blurred(8);
  const std::vector<std::uint8_t> noisy = noisy_alpha(beauty);
  Image denoised(kSize, kSize, 4, 1.25f);
  pass_on_alpha(beauty, noisy, denoised);
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    const float alpha = denoised.data()[4 * i + 3];
    EXPECT_EQ(alpha, noisy[i] ? 1.0f : beauty.data()[4 * i + 3]);
    EXPECT_EQ(denoised.data()[4 * i], 1.25f);
  }
}

TEST(EmptyPixels, AreThoseWithoutColourWhereTransparentPixelsHaveNone) {
  Image beauty(9, 1, 4);
  beauty.at(0, 0, 3) = 1.0f;  // black and opaque
  beauty.at(8, 0, 0) = 2.0f;  // light without alpha
  const std::vector<std::uint8_t> expected{0, 1, 1, 1, 1, 1, 0, 0, 0};
  std::vector<std::uint8_t> noisy(9);
  EXPECT_EQ(empty_pixels(beauty, noisy), expected);
  noisy[1] = 1;
  EXPECT_EQ(empty_pixels(beauty, noisy), (std::vector<std::uint8_t>{0, 0, 0, 0, 1, 1, 0, 0, 0}));
  noisy[1] = 0;
  beauty.at(0, 0, 3) = 0.0f;
  EXPECT_EQ(std::ranges::count(empty_pixels(beauty, noisy), 1), 0) << "no matte at all";
}

}  // namespace
}  // namespace becalm::filter
