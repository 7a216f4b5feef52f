// A packed estimate is restored to within a thousandth of each value.
#include "filter/sequence/packed_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

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
