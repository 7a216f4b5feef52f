// A packed estimate is restored to within a thousandth of each value.
#include "filter/sequence/packed_estimate.h"

#include <gtest/gtest.h>
#include <half.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "filter/sequence/half_values.h"
#include "filter/task.h"

namespace becalm::filter {
namespace {

constexpr gpu::Extent kSize{21, 13};

/// An estimate with radiance around `usual`, with fireflies and black pixels.
Estimate estimate_around(float usual, std::size_t carried) {
  Estimate estimate(kSize, carried);
  std::mt19937 random(3);
  std::lognormal_distribution<float> spread(0, 2);
  const auto fill = [&](Image& image, float scale) {
    for (float& value : image.data()) value = random() % 17 == 0 ? 0.0f : scale * spread(random);
    image.data()[5] = 1e7f * scale;
    image.data()[9] = -1e-7f * scale;
  };
  fill(estimate.color, usual);
  for (Image& image : estimate.carried) fill(image, usual);
  for (std::size_t i = 0; i < estimate.stats.pixel_count(); ++i) {
    estimate.stats.data()[2 * i] = usual * usual * spread(random);
    estimate.stats.data()[2 * i + 1] = static_cast<float>(i % 40);
  }
  return estimate;
}

void expect_near(const Image& found, const Image& expected) {
  ASSERT_TRUE(found.same_shape(expected));
  for (std::size_t i = 0; i < found.data().size(); ++i) {
    // Twice the error, since variances are stored as standard deviations.
    ASSERT_NEAR(found.data()[i], expected.data()[i], 0x1p-9f * std::abs(expected.data()[i])) << i;
  }
}

TEST(PackedEstimate, ComesBackToAThousandth) {
  for (const float usual : {1e-15f, 1.0f, 1e15f}) {
    const std::size_t carried = FilterTask::kNoisyLayers;
    Estimate estimate = estimate_around(usual, carried);
    for (float& value : estimate.carried[0].data()) value = std::abs(value);  // a variance among them
    estimate.noise = estimate.stats;
    const Estimate found = PackedEstimate(estimate, 1.0f / usual, FilterTask::kNoisyLayers).estimate();
    expect_near(found.color, estimate.color);
    expect_near(found.stats, estimate.stats);
    expect_near(found.noise, estimate.noise);
    ASSERT_EQ(found.carried.size(), carried);
    for (std::size_t i = 0; i < carried; ++i) expect_near(found.carried[i], estimate.carried[i]);
  }
}

TEST(HalfImage, ManyValuesThatNoHalfStandsForStayFloats) {
  // A component of a plane's normal that rounding left: far below the least half that is exact to a
  // thousandth.
  Image normals(64, 9, 3, 0.1f);  // no half is 0.1, but one is near enough to stand for it
  for (std::size_t i = 0; i < normals.data().size(); i += 3) normals.data()[i] = -4.37e-8f;
  normals.data()[4] = std::numeric_limits<float>::quiet_NaN();
  const Image found = HalfImage(normals, {1.0f, 1.0f, 1.0f}).image();
  for (std::size_t i = 0; i < normals.data().size(); ++i) {
    if (i == 4) continue;
    ASSERT_EQ(found.data()[i], normals.data()[i]) << i;
  }
  EXPECT_TRUE(std::isnan(found.data()[4]));
}

/// Halves by the processor's instructions are those of Imath.
TEST(HalfImage, EveryHalfComesBack) {
  std::vector<std::uint16_t> bits(1 << 16);
  std::iota(bits.begin(), bits.end(), std::uint16_t{0});
  const ChannelFactors one({1.0f});
  for (std::size_t first = 0; first + kHalfBlock <= bits.size(); first += kHalfBlock) {
    std::array<float, kHalfBlock> values{};
    std::array<std::uint16_t, kHalfBlock> back{};
    from_halves(&bits[first], one, values.data());
    const std::uint32_t missed = to_halves(values.data(), one, 0x1p-10f, back.data());
    for (std::size_t i = 0; i < kHalfBlock; ++i) {
      const float expected = imath_half_to_float(bits[first + i]);
      const bool stands_for_it = std::isfinite(expected);
      ASSERT_EQ((missed >> i & 1) == 0, stands_for_it) << bits[first + i];
      if (!std::isnan(expected)) {
        ASSERT_EQ(values[i], expected) << bits[first + i];
      }
      if (stands_for_it) {
        ASSERT_EQ(back[i], bits[first + i]);
      }
    }
  }
}

TEST(HalfImage, HalvesAreRoundedAsImathDoes) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> exponent(-30.0f, 20.0f);
  const ChannelFactors factors({3.0f, 0.25f});
  for (int n = 0; n < 1000; ++n) {
    std::array<float, kHalfBlock> values{};
    std::array<std::uint16_t, kHalfBlock> halves{};
    for (float& value : values) value = std::exp2(exponent(random)) * (random() % 2 == 0 ? 1.0f : -1.0f);
    to_halves(values.data(), factors, 0x1p-10f, halves.data());
    for (std::size_t i = 0; i < kHalfBlock; ++i)
      ASSERT_EQ(halves[i], imath_float_to_half(values[i] * factors.data()[i])) << values[i];
  }
}

TEST(PackedEstimate, WhatAddsUpStillDoes) {
  constexpr std::size_t kFirst = 0;
  constexpr std::size_t kSecond = 1;
  constexpr std::size_t kWhole = 2;
  Estimate estimate = estimate_around(1.0f, 2 + FilterTask::kNoisyLayers);
  for (std::size_t i = 0; i < estimate.color.data().size(); ++i) {
    float& whole = estimate.carried[kWhole].data()[i];
    if (i % 4 == 3) whole = std::abs(whole);
    estimate.carried[kSecond].data()[i] = whole - estimate.carried[kFirst].data()[i];
  }
  const Estimate found = PackedEstimate(estimate, 1.0f, FilterTask::kNoisyLayers).estimate();
  for (std::size_t i = 0; i < estimate.color.data().size(); ++i) {
    if (i % 4 == 3) continue;
    const float first = found.carried[kFirst].data()[i];
    const float second = found.carried[kSecond].data()[i];
    ASSERT_NEAR(first + second, found.carried[kWhole].data()[i],
                1e-6f * (std::abs(first) + std::abs(second)));
  }
}

TEST(PackedEstimate, NothingIsCarriedWhereNothingWas) {
  const Estimate estimate = estimate_around(2.0f, 0);
  const Estimate found = PackedEstimate(estimate, 0.5f, 0).estimate();
  EXPECT_TRUE(found.carried.empty());
  EXPECT_TRUE(found.noise.empty());
  expect_near(found.color, estimate.color);
}

}  // namespace
}  // namespace becalm::filter
