// Points and spots: the inverse square, the falloff and its integral, and the extremes.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/tracer/shading/light_estimate.h"
#include "tests/tracer/shading/statistics.h"
#include "tracer/lights/point_light.h"
#include "tracer/lights/spot_light.h"

namespace becalm::tracer {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(PointLight, irradiance_is_cos_over_the_squared_distance) {
  const PointLight light = {V3f(1, 4, -2), V3f(5, 6, 7), 0, {}};
  const auto drawn = light.sample(V3f(-2, 1, 2));
  ASSERT_TRUE(drawn);
  EXPECT_TRUE(drawn->delta);
  const double squared = 9 + 9 + 16;
  EXPECT_NEAR(drawn->distance, std::sqrt(squared), 1e-6);
  EXPECT_NEAR(irradiance(drawn, V3f(0, 1, 0)), 5.0 / squared * 3.0 / std::sqrt(squared), 1e-7);
  EXPECT_NEAR(drawn->radiance.z, 7.0 / squared, 1e-7);
  EXPECT_NEAR(light.radiant_intensity(), 6.0, 1e-6);
}

TEST(PointLight, extremes_are_finite) {
  const PointLight bright = {V3f(0), V3f(1e30f), 0, {}};
  constexpr float largest = std::numeric_limits<float>::max();
  EXPECT_FALSE(bright.sample(V3f(0)));
  EXPECT_FALSE(bright.sample(V3f(NAN, 0, 0)));
  for (const float distance : {1e-30f, 1e-6f, 1e-3f, 1.0f, 1e12f, 1e30f}) {
    const auto drawn = bright.sample(V3f(0, distance, 0));
    ASSERT_TRUE(drawn) << distance;
    EXPECT_EQ(drawn->distance, distance);
    EXPECT_EQ(drawn->dir_world, V3f(0, -1, 0)) << distance;
    const double exact = static_cast<double>(1e30f) / (static_cast<double>(distance) * distance);
    EXPECT_FLOAT_EQ(drawn->radiance.y, exact < largest ? static_cast<float>(exact) : largest) << distance;
  }
}

SpotEmitter spot_of(float inner_deg, float outer_deg) {
  return SpotEmitter({V3f(1, 2, 3), V3f(0.2f, -3.0f, 1.0f), V3f(4.0f), inner_deg, outer_deg, 0, {}});
}

/// The share of the intensity at an angle from the axis, by a sample from a distance of 2.
double share_at(const SpotEmitter& spot, double angle_deg) {
  const V3d side = spot.axis.cross(V3d(1, 0, 0)).normalized();
  const double angle = angle_deg * kPi / 180.0;
  const V3d position = V3d(spot.position) + (spot.axis * std::cos(angle) + side * std::sin(angle)) * 2.0;
  const auto drawn = spot.sample(V3f(position));
  return drawn ? drawn->radiance.x * 4.0 / spot.intensity.x : 0.0;
}

/// The smoothstep is 1/2 on average over the solid angle between the cones.
double power_of(const SpotEmitter& spot) {
  return kPi * (spot.inner + spot.outer) * spot.radiant_intensity();
}

TEST(SpotLight, falls_off_smoothly_between_its_cones) {
  const SpotEmitter spot = spot_of(20.0f, 40.0f);
  for (const double angle_deg : {0.0, 10.0, 19.9}) EXPECT_NEAR(share_at(spot, angle_deg), 1.0, 1e-5);
  for (const double angle_deg : {40.1, 90.0, 180.0}) EXPECT_EQ(share_at(spot, angle_deg), 0.0);
  for (const double angle_deg : {22.0, 30.0, 35.0, 39.0}) {
    const auto cosine = [](double deg) { return std::cos(deg * kPi / 180.0); };
    const double t = (cosine(angle_deg) - cosine(40.0)) / (cosine(20.0) - cosine(40.0));
    EXPECT_NEAR(share_at(spot, angle_deg), t * t * (3.0 - 2.0 * t), 1e-5) << angle_deg;
  }
}

/// The flux that leaves is the integral of the intensity, however wide the cone.
TEST(SpotLight, power_is_the_integral_of_the_falloff) {
  for (const auto& [inner, outer] : {std::pair(0.0f, 30.0f), std::pair(20.0f, 40.0f), std::pair(45.0f, 45.0f),
                                     std::pair(80.0f, 170.0f), std::pair(180.0f, 180.0f)}) {
    const SpotEmitter spot = spot_of(inner, outer);
    const double end = outer * kPi / 180.0, start = inner * kPi / 180.0;
    const auto ring = [&](const V2d& p) {
      return 4.0 * share_at(spot, p.y * 180.0 / kPi) * std::sin(p.y) * 2.0 * kPi;
    };
    double flux = integrate(ring, {0.0, 1.0, 0.0, start}, 1e-5);
    if (end > start) flux += integrate(ring, {0.0, 1.0, start, end}, 1e-5);
    EXPECT_NEAR(flux / power_of(spot), 1.0, 1e-4) << inner << " " << outer;
  }
}

TEST(SpotLight, lights_a_plane_as_its_cone_says) {
  // Straight down onto a plane: E = I f(theta) cos^3 / h^2, integrated over the plane it is the flux again.
  const SpotEmitter spot({V3f(0, 2, 0), V3f(0, -1, 0), V3f(4.0f), 10.0f, 50.0f, 0, {}});
  const double reach = 2.0 * std::tan(50.0 * kPi / 180.0);
  const double flux = integrate(
      [&](const V2d& p) {
        return irradiance(spot.sample(V3f(static_cast<float>(p.x), 0, 0)), V3f(0, 1, 0)) * 2.0 * kPi * p.x;
      },
      {0.0, reach, 0.0, 1.0}, 1e-5);
  EXPECT_NEAR(flux / power_of(spot), 1.0, 1e-4);
}

TEST(SpotLight, narrow_cones_keep_their_falloff) {
  // 1 - cos of 0.01 degrees is 1.5e-8: below the resolution of float.
  const SpotEmitter spot({V3f(0, 0, 0), V3f(0, 0, 1), V3f(1.0f), 0.005f, 0.01f, 0, {}});
  const auto share = [&](double angle_deg) {
    const double x = 1000.0 * std::tan(angle_deg * kPi / 180.0);
    const auto drawn = spot.sample(V3f(V3d(x, 0.0, 1000.0)));
    return drawn ? drawn->radiance.x * 1e6 : 0.0;
  };
  EXPECT_NEAR(share(0.0049), 1.0, 1e-3);
  const double t = (1.0 - 0.75 * 0.75) / 0.75;  // angles squared: versines of small angles
  EXPECT_NEAR(share(0.0075), t * t * (3.0 - 2.0 * t), 1e-3);
  EXPECT_EQ(share(0.0101), 0.0);
  EXPECT_GT(spot.radiant_intensity(), 0.0);
}

TEST(SpotLight, without_a_direction_it_is_dark) {
  const SpotEmitter spot({V3f(0), V3f(0), V3f(1e30f), 10.0f, 170.0f, 0, {}});
  EXPECT_EQ(spot.radiant_intensity(), 0.0);
  EXPECT_FALSE(spot_of(10.0f, 20.0f).sample(V3f(1, 2, 3)));
}

}  // namespace
}  // namespace becalm::tracer
