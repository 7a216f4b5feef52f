// Suns: the disc's samples against their density, irradiance, and discs as small as float directions resolve.
#include "tracer/lights/sun_light.h"

#include <Imath/ImathMatrixAlgo.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/tracer/shading/light_estimate.h"
#include "tests/tracer/shading/statistics.h"

namespace becalm::tracer {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
const V3f kDirection(-0.4f, 2.0f, 0.7f);

SunEmitter sun_of(float diameter_deg, float irradiance = 3.0f) {
  return SunEmitter({kDirection, diameter_deg, V3f(irradiance), 0});
}

TEST(SunLight, samples_match_their_density) {
  std::uint32_t seed = 400;
  const M44d to_pole = Imath::rotationMatrix(V3d(kDirection).normalized(), V3d(0.0, 0.0, 1.0));
  for (const float diameter_deg : {2.0f, 30.0f, 180.0f}) {
    const SunEmitter sun = sun_of(diameter_deg);
    Chart chart = sphere_chart(
        [&](TestRandom& random) -> std::optional<V3f> {
          return V3f(transform_vector(V3d(sun.sample(random.next_2d()).dir_world), to_pole));
        },
        [&](const V3f& w) {
          const V3f dir(transform_vector(V3d(w), to_pole.transposed()));
          return sun.contains(dir) ? sun.pdf_solid_angle() : 0.0f;
        });
    chart.jumps_y = {0.5 * diameter_deg * kRadPerDeg};
    const SamplerTest test = test_sampler(chart, ++seed);
    EXPECT_GT(test.result.p_value, sidak_level(0.01, 3)) << diameter_deg << ": " << test.replay;
    EXPECT_NEAR(test.integral, 1.0, 1e-3) << diameter_deg;
  }
}

TEST(SunLight, disc_of_a_hundredth_degree) {
  const SunEmitter sun = sun_of(0.01f);
  ASSERT_FALSE(sun.delta());
  const double radius = 0.005 * kRadPerDeg;
  EXPECT_NEAR(sun.pdf_solid_angle() * std::numbers::pi * radius * radius, 1.0, 1e-5);
  const V3d axis = V3d(kDirection).normalized();
  const V3d side = axis.cross(V3d(0, 0, 1)).normalized(), up = side.cross(axis);
  constexpr int samples = 100000, rings = 10, sectors = 8;
  std::vector<double> observed(rings * sectors, 0.0);
  int outside = 0;
  TestRandom random(410);
  for (int i = 0; i < samples; ++i) {
    const V3f dir = sun.sample(random.next_2d()).dir_world;
    if (!sun.contains(dir)) ++outside;
    const double x = V3d(dir).dot(side), y = V3d(dir).dot(up);
    const int ring = std::min(rings - 1, static_cast<int>((x * x + y * y) / (radius * radius) * rings));
    const double turn = std::atan2(y, x) / (2.0 * std::numbers::pi) + 0.5;
    observed[ring * sectors + std::min(sectors - 1, static_cast<int>(turn * sectors))] += 1.0;
  }
  const ChiSquare result = chi_square(
      observed, std::vector<double>(rings * sectors, static_cast<double>(samples) / (rings * sectors)));
  EXPECT_GT(result.p_value, 0.01) << "seed 410 chi^2 " << result.statistic;
  EXPECT_LT(outside, samples / 500) << "rounding of directions alone puts samples beyond the rim";
}

TEST(SunLight, irradiance_is_as_given) {
  const V3f axis = kDirection.normalized();
  const V3f tilted = V3f(0.5f, 0.6f, -0.2f).normalized();
  for (const float diameter_deg : {0.0f, 1e-3f, 0.01f, 0.533f, 20.0f}) {
    const SunEmitter sun = sun_of(diameter_deg);
    for (const V3f& normal : {axis, tilted}) {
      const Estimate found = estimate(420, 20000, [&](TestRandom& random) {
        return irradiance(std::optional(sun.sample(random.next_2d())), normal);
      });
      EXPECT_NEAR(found.mean, 3.0 * normal.dot(axis), 4.0 * found.error + 2e-6) << diameter_deg;
    }
  }
}

TEST(SunLight, contains_its_disc_alone) {
  for (const float diameter_deg : {0.01f, 0.5f, 100.0f}) {
    const SunEmitter sun(SunLight{V3f(0, 0, 1e-30f), diameter_deg, V3f(1.0f), 0});
    const auto at = [](double angle_deg) {
      return V3f(V3d(std::sin(angle_deg * kRadPerDeg), 0.0, std::cos(angle_deg * kRadPerDeg)));
    };
    EXPECT_TRUE(sun.contains(at(0.0)));
    EXPECT_TRUE(sun.contains(at(0.499 * diameter_deg))) << diameter_deg;
    EXPECT_FALSE(sun.contains(at(0.501 * diameter_deg))) << diameter_deg;
    EXPECT_FALSE(sun.contains(at(180.0))) << diameter_deg;
  }
}

TEST(SunLight, is_a_delta_where_float_cannot_hold_the_disc) {
  for (const SunEmitter& sun : {sun_of(0.0f, 1e30f), sun_of(9e-5f), sun_of(1.1e-4f, 1e30f)}) {
    EXPECT_TRUE(sun.delta());
    const LightSample drawn = sun.sample(V2f(0.9f, 0.3f));
    EXPECT_TRUE(drawn.delta);
    EXPECT_EQ(drawn.radiance, sun.irradiance);
    EXPECT_EQ(drawn.dir_world, V3f(V3d(kDirection).normalized()));
    EXPECT_FALSE(sun.contains(drawn.dir_world));
  }
  const SunEmitter smallest = sun_of(1.1e-4f);
  EXPECT_FALSE(smallest.delta());
  EXPECT_TRUE(is_finite(smallest.radiance) && std::isfinite(smallest.pdf_solid_angle()));
}

}  // namespace
}  // namespace becalm::tracer
