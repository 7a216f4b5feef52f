#include "tracer/procedural/ocean.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/tracer/procedural/fields.h"

namespace becalm::tracer::test {
namespace {

float height_at(const Ocean& ocean, float x, float z) {
  return ocean.point(V3f(x, 0.0f, z), 0.0f).position.y;
}

OceanDescription at_time(OceanDescription ocean, double time_s) {
  ocean.time_s = constant(time_s);
  return ocean;
}

TEST(Ocean, AWaveRunsAtDeepWatersSpeed) {
  OceanDescription description;
  description.size = 50.0;
  description.wavelength = description.shortest_wavelength = 4.0;
  description.trains = 1;
  description.spread_deg = 0.0;
  description.wind_deg = 30.0;
  description.wave_height = constant(0.4);
  const WaveTrains trains = make_wave_trains(description, 0.0);
  const double wavelength = description.size / std::hypot(trains.kx[0], trains.kz[0]);
  // Phase speed sqrt(g / k): after a time the same heights stand that much further downwind.
  const double speed = std::sqrt(description.gravity * wavelength / (2.0 * std::numbers::pi));
  Ocean before, after;
  before.update(at_time(description, 10.0), 0.0);
  after.update(at_time(description, 10.7), 0.0);
  const V2d run = 0.7 * speed * V2d(std::cos(std::numbers::pi / 6.0), std::sin(std::numbers::pi / 6.0));
  double largest = 0.0;
  for (int k = 0; k < 200; ++k) {
    const float x = 0.1f * static_cast<float>(k) - 10.0f, z = 0.07f * static_cast<float>(k) - 8.0f;
    const double there = height_at(after, x + static_cast<float>(run.x), z + static_cast<float>(run.y));
    ASSERT_NEAR(height_at(before, x, z), there, 1e-4);
    largest = std::max(largest, there);
  }
  // One sine whose significant height is four standard deviations.
  EXPECT_NEAR(largest, 0.4 / 4.0 * std::sqrt(2.0), 2e-3);
}

TEST(Ocean, HeightHasTheDeviationAskedFor) {
  OceanDescription description = small_ocean(100.0);
  description.wavelength = 5.0;
  Ocean ocean;
  ocean.update(description, 0.0);
  double sum = 0.0, squares = 0.0;
  constexpr int kSide = 200;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const double h =
          height_at(ocean, 100.0f * (i + 0.5f) / kSide - 50.0f, 100.0f * (j + 0.5f) / kSide - 50.0f);
      sum += h;
      squares += h * h;
    }
  }
  const double n = kSide * kSide;
  EXPECT_NEAR(sum / n, 0.0, 0.05);
  EXPECT_NEAR(std::sqrt(squares / n), 2.0 / 4.0, 0.05);
}

TEST(Ocean, TimeIsContinuous) {
  const OceanDescription description = small_ocean(10.0);
  Ocean before, after;
  before.update(at_time(description, 123.0), 0.0);
  after.update(at_time(description, 123.0 + 1e-4), 0.0);
  float most = 0.0f;
  for (int k = 0; k < 500; ++k) {
    const float x = 0.01f * static_cast<float>(k) - 2.0f;
    most = std::max(most, std::abs(height_at(before, x, 1.0f) - height_at(after, x, 1.0f)));
  }
  EXPECT_GT(most, 0.0f);
  EXPECT_LT(most, 1e-3f);
}

TEST(Ocean, WhatAveragingTakesFromTheNormalIsReported) {
  const OceanDescription description = small_ocean(1.0);
  Ocean ocean;
  ocean.update(description, 0.0);
  const auto slope = [](const V3f& n) { return V2f(-n.x / n.y, -n.z / n.y); };
  EXPECT_EQ(ocean.point(V3f(0.1f, 0.0f, 0.1f), 0.0f).slope_variance, 0.0f);
  for (const float footprint : {0.01f, 0.03f, 0.1f, 10.0f}) {
    double all = 0.0, kept = 0.0, reported = 0.0;
    constexpr int kSide = 100;
    for (int k = 0; k < kSide * kSide; ++k) {
      const V3f p((k % kSide + 0.5f) / kSide - 0.5f, 0.0f, (k / kSide + 0.5f) / kSide - 0.5f);
      const ProceduralPoint fine = ocean.point(p, 0.0f), wide = ocean.point(p, footprint);
      EXPECT_EQ(fine.position, wide.position);
      all += slope(fine.normal).length2();
      kept += slope(wide.normal).length2();
      reported += wide.slope_variance;
    }
    EXPECT_NEAR(reported / all, 1.0 - kept / all, 0.04) << footprint;
    if (footprint > 1.0f) {
      EXPECT_LT(kept / all, 1e-6);
    }
  }
}

TEST(Ocean, FlatWaterIsAPlane) {
  OceanDescription description = small_ocean(2.0);
  description.wave_height = constant(0.0);
  Ocean ocean;
  ocean.update(description, 0.0);
  const auto t = ocean.intersect(V3f(0.3f, 2.0f, 0.2f), V3f(0.0f, -1.0f, 0.0f), 0.0f, 10.0f);
  ASSERT_TRUE(t);
  EXPECT_NEAR(*t, 2.0f, 1e-5f);
  EXPECT_EQ(ocean.point(V3f(0.3f, 0.0f, 0.2f), 0.0f).normal, V3f(0.0f, 1.0f, 0.0f));
}

}  // namespace
}  // namespace becalm::tracer::test
