// The choice among lights: its shares, densities that match, and what is never chosen.
#include "tracer/lights/lights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/tracer/shading/statistics.h"

namespace becalm::tracer {
namespace {

EmissiveTriangle facing_down(float x, float radiance) {
  return {V3f(x, 1, 0), V3f(x + 1, 1, 0), V3f(x, 1, 1), V3f(radiance), false};
}

Lights lights_of(std::vector<EmissiveTriangle> triangles, std::optional<Environment> environment = {},
                 float scene_radius = 0.0f) {
  LightList list;
  list.triangles = std::move(triangles);
  list.environment = std::move(environment);
  list.scene_radius = scene_radius;
  return Lights(std::move(list));
}

/// Density with which the environment finds the direction; 0 without one.
float pdf_environment(const Lights& lights, const V3f& dir) {
  float found = 0.0f;
  lights.for_each_infinite(dir, [&](const V3f&, float pdf, std::uint16_t) { found = pdf; });
  return found;
}

/// Which triangle a sample came from, by its radiance; triangles.size() for the environment.
std::size_t source(const std::vector<EmissiveTriangle>& triangles, const LightSample& drawn) {
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (drawn.radiance == triangles[i].radiance) return i;
  }
  return triangles.size();
}

TEST(Lights, chosen_by_power_with_matching_densities) {
  const std::vector<EmissiveTriangle> triangles = {facing_down(-2, 1.0f), facing_down(0, 5.0f),
                                                   facing_down(2, 4.0f)};
  const Lights lights = lights_of(triangles, Environment::constant(V3f(0.25f)));
  const V3f point(0.2f, 0.0f, 0.3f);
  TestRandom random(21);
  std::vector<double> observed(4, 0.0);
  constexpr int samples = 40000;
  for (int i = 0; i < samples; ++i) {
    const float u_light = random.next();
    const auto drawn = lights.sample(point, 0.0f, u_light, random.next_2d());
    ASSERT_TRUE(drawn);
    const std::size_t index = source(triangles, *drawn);
    observed[index] += 1.0;
    if (index == 3) {
      ASSERT_TRUE(std::isinf(drawn->distance));
      ASSERT_EQ(drawn->pdf_solid_angle, pdf_environment(lights, drawn->dir_world));
    } else {
      ASSERT_EQ(drawn->pdf_solid_angle,
                lights.pdf_triangle(index, point, drawn->dir_world, drawn->distance, 0.0f));
    }
  }
  // Without a radius the environment takes half.
  const ChiSquare result =
      chi_square(observed, {0.05 * samples, 0.25 * samples, 0.2 * samples, 0.5 * samples});
  EXPECT_GT(result.p_value, 0.01) << "seed 21 chi^2 " << result.statistic;
}

double environment_share(const Lights& lights) {
  return pdf_environment(lights, V3f(0, 1, 0)) * 4.0 * std::numbers::pi;
}

TEST(Lights, environment_share_follows_the_scene_radius) {
  const auto share = [](float radiance, float radius) {
    return environment_share(lights_of({facing_down(0, 1.0f)}, Environment::constant(V3f(radiance)), radius));
  };
  // Triangle: pi * 1/2. Environment: pi r^2 * 4 pi L.
  const double expected = 4.0 * std::numbers::pi * 0.05 / (4.0 * std::numbers::pi * 0.05 + 0.5);
  EXPECT_NEAR(share(0.05f, 1.0f), expected, 1e-6);
  EXPECT_NEAR(share(1e-6f, 1.0f), 0.1, 1e-6);
  EXPECT_NEAR(share(1e6f, 1e3f), 0.9, 1e-6);
  EXPECT_NEAR(share(0.05f, 0.0f), 0.5, 1e-6);
  EXPECT_NEAR(share(0.0f, 1.0f), 0.0, 1e-6);
}

TEST(Lights, the_only_kind_takes_all) {
  EXPECT_NEAR(environment_share(lights_of({}, Environment::constant(V3f(2.0f)))), 1.0, 1e-6);
  EXPECT_NEAR(environment_share(lights_of({facing_down(0, 0.0f)}, Environment::constant(V3f(2.0f)), 1.0f)),
              1.0, 1e-6);
}

TEST(Lights, nothing_to_sample) {
  const EmissiveTriangle flat = {V3f(0), V3f(1, 0, 0), V3f(2, 0, 0), V3f(1e30f), true};
  for (const Lights& lights : {Lights(), lights_of({}), lights_of({flat}),
                               lights_of({facing_down(0, 0.0f)}, Environment::constant(V3f(0.0f)))}) {
    EXPECT_TRUE(lights.empty());
    EXPECT_FALSE(lights.sample(V3f(0), 0.0f, 0.5f, V2f(0.5f)));
    EXPECT_EQ(pdf_environment(lights, V3f(0, 1, 0)), 0.0f);
  }
}

TEST(Lights, degenerate_triangles_are_never_chosen) {
  const EmissiveTriangle flat = {V3f(0), V3f(1, 0, 0), V3f(2, 0, 0), V3f(1e30f), true};
  EmissiveTriangle broken = facing_down(0, 1.0f);
  broken.radiance.y = NAN;
  const std::vector<EmissiveTriangle> triangles = {flat, facing_down(0, 2.0f), broken, flat};
  const Lights lights = lights_of(triangles);
  for (int i = 0; i <= 64; ++i) {
    const auto drawn =
        lights.sample(V3f(0.2f, 0, 0.2f), 0.0f, std::min(i / 64.0f, 0x1.fffffep-1f), V2f(0.4f, 0.3f));
    ASSERT_TRUE(drawn);
    EXPECT_EQ(drawn->radiance, V3f(2.0f));
  }
  EXPECT_EQ(lights.pdf_triangle(0, V3f(0), V3f(0, 1, 0), 1.0f, 0.0f), 0.0f);
  EXPECT_EQ(lights.pdf_triangle(2, V3f(0), V3f(0, 1, 0), 1.0f, 0.0f), 0.0f);
}

TEST(Lights, extreme_radiances_stay_finite) {
  const std::vector<EmissiveTriangle> triangles = {facing_down(0, 1e30f), facing_down(2, 1e-30f)};
  const Lights lights = lights_of(triangles, Environment::constant(V3f(1e30f)), 1e6f);
  TestRandom random(8);
  for (int i = 0; i < 1000; ++i) {
    const float u_light = random.next();
    const auto drawn = lights.sample(V3f(0.2f, 0, 0.2f), 0.0f, u_light, random.next_2d());
    ASSERT_TRUE(drawn) << "u_light " << u_light;
    ASSERT_TRUE(std::isfinite(drawn->pdf_solid_angle) && drawn->pdf_solid_angle > 0.0f);
    ASSERT_TRUE(is_finite(drawn->radiance));
  }
}

/// Irradiance below a disc-like square: light sampling gives the analytic value.
TEST(Lights, irradiance_of_a_rectangle_overhead) {
  // Square [-1,1]^2 at height 1, seen from its centre: E = L * 4 * form factor of a quarter, by the usual
  // arctangents.
  const float radiance = 3.0f;
  const Lights lights = lights_of({{V3f(-1, 1, -1), V3f(1, 1, -1), V3f(1, 1, 1), V3f(radiance), false},
                                   {V3f(-1, 1, -1), V3f(1, 1, 1), V3f(-1, 1, 1), V3f(radiance), false}});
  const double h = std::sqrt(2.0);
  const double quarter =
      (1.0 / h * std::atan(1.0 / h)) / std::numbers::pi;  // twice 1/(2 pi) of the same term
  TestRandom random(77);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int samples = 50000;
  for (int i = 0; i < samples; ++i) {
    const float u_light = random.next();
    const auto drawn = lights.sample(V3f(0), 0.0f, u_light, random.next_2d());
    ASSERT_TRUE(drawn);
    const double value = drawn->radiance.x * drawn->dir_world.y / drawn->pdf_solid_angle;
    sum += value;
    squares += value * value;
  }
  const double mean = sum / samples;
  const double error = std::sqrt((squares / samples - mean * mean) / samples);
  EXPECT_NEAR(mean, radiance * std::numbers::pi * 4.0 * quarter, 4.0 * error);
}

}  // namespace
}  // namespace becalm::tracer
