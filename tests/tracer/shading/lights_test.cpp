// The choice among lights: its shares, densities that match, and what is never chosen.
#include "tracer/lights/lights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/tracer/shading/light_estimate.h"
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

/// One light of each kind, each of its own group and radiance.
LightList one_of_each() {
  LightList list;
  list.triangles = {{V3f(-1, 3, -1), V3f(1, 3, -1), V3f(0, 3, 1), V3f(1.0f), false, 11, {}}};
  list.spheres = {{V3f(2, 3, 0), 0.5f, V3f(2.0f), false, 12, {}}};
  list.points = {{V3f(0, 2, 2), V3f(3.0f), 13, {}}};
  list.spots = {{V3f(0, 2, -2), V3f(0, -1, 1), V3f(4.0f), 20.0f, 60.0f, 14, {}}};
  list.suns = {{V3f(1, 1, 0), 10.0f, V3f(0.5f), 15}, {V3f(-1, 1, 0), 0.0f, V3f(0.25f), 16}};
  list.environment = Environment::constant(V3f(0.125f));
  list.environment_group = 17;
  list.scene_radius = 3.0f;
  return list;
}

TEST(Lights, samples_carry_their_group_and_density) {
  const LightList list = one_of_each();
  const Lights lights{list};
  const V3f point(0.1f, 0.2f, -0.1f);
  TestRandom random(31);
  std::vector<int> seen(18, 0);
  double share_of_deltas = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const float u_light = random.next();
    const auto drawn = lights.sample(point, 0.0f, u_light, random.next_2d());
    ASSERT_TRUE(drawn);
    ++seen.at(drawn->group);
    ASSERT_EQ(drawn->delta, drawn->group == 13 || drawn->group == 14 || drawn->group == 16);
    ASSERT_EQ(std::isinf(drawn->distance), drawn->group >= 15);
    if (drawn->delta && seen[drawn->group] == 1) share_of_deltas += drawn->pdf_solid_angle;
    if (drawn->group == 11) {
      ASSERT_EQ(drawn->pdf_solid_angle,
                lights.pdf_triangle(0, point, drawn->dir_world, drawn->distance, 0.0f));
    } else if (drawn->group == 12) {
      ASSERT_EQ(drawn->pdf_solid_angle, lights.pdf_sphere(0, point, 0.0f));
    } else if (drawn->group == 15 || drawn->group == 17) {
      lights.for_each_infinite(drawn->dir_world, [&](const V3f& radiance, float pdf, std::uint16_t group) {
        if (group != drawn->group) return;
        ASSERT_EQ(drawn->pdf_solid_angle, pdf);
        ASSERT_EQ(drawn->radiance, radiance);
      });
    }
  }
  for (int group = 11; group <= 17; ++group) EXPECT_GT(seen[group], 0) << group;
  // The pdf of a delta light is the probability of having chosen it.
  EXPECT_NEAR(seen[13] + seen[14] + seen[16], 20000 * share_of_deltas, 4.0 * std::sqrt(20000.0 * 0.25));
}

TEST(Lights, rays_that_escape_see_the_environment_and_the_discs) {
  const Lights lights{one_of_each()};
  const auto groups = [&](const V3f& dir) {
    std::vector<std::pair<int, float>> found;
    lights.for_each_infinite(dir.normalized(), [&](const V3f& radiance, float, std::uint16_t group) {
      found.emplace_back(group, radiance.x);
    });
    return found;
  };
  const double sine = std::sin(5.0 * std::numbers::pi / 180.0);
  const auto in_disc = groups(V3f(1, 1.05f, 0));
  ASSERT_EQ(in_disc.size(), 2u);
  EXPECT_EQ(in_disc[0], std::pair(17, 0.125f));
  EXPECT_EQ(in_disc[1].first, 15);
  EXPECT_NEAR(in_disc[1].second, 0.5 / (std::numbers::pi * sine * sine), 1e-4);
  // A sun without size is seen by nobody.
  EXPECT_EQ(groups(V3f(-1, 1, 0)).size(), 1u);
}

/// All that one_of_each() sends to a horizontal surface is found by one estimator.
TEST(Lights, irradiance_of_all_kinds_together) {
  const LightList list = one_of_each();
  const V3f point(0.1f, 0.2f, -0.1f);
  double expected = 0.0;
  std::vector<LightList> alone(7);
  alone[0].triangles = list.triangles;
  alone[1].spheres = list.spheres;
  alone[2].points = list.points;
  alone[3].spots = list.spots;
  alone[4].suns = {list.suns[0]};
  alone[5].suns = {list.suns[1]};
  alone[6].environment = list.environment;
  const V3f up(0, 1, 0);
  double error = 0.0;
  const auto found_by = [&](const Lights& lights, std::uint32_t seed) {
    return estimate(seed, 40000, [&](TestRandom& random) {
      const float u_light = random.next();
      return irradiance(lights.sample(point, 0.0f, u_light, random.next_2d()), up);
    });
  };
  for (std::uint32_t i = 0; i < alone.size(); ++i) {
    const Estimate part = found_by(Lights{alone[i]}, 50 + i);
    expected += part.mean;
    error += part.error * part.error;
  }
  const Estimate whole = found_by(Lights{list}, 60);
  EXPECT_NEAR(whole.mean, expected, 4.0 * std::sqrt(error + whole.error * whole.error));
  EXPECT_LT(whole.error, 0.01 * whole.mean);
}

TEST(Lights, no_kind_is_starved) {
  // Shares of the sun (a delta: its pdf), the sphere and the environment.
  const auto shares = [](float sphere, float sun, float environment, float radius = 1.0f) {
    LightList list;
    list.spheres = {{V3f(0, 3, 0), 1.0f, V3f(sphere), false, 0, {}}};
    list.suns = {{V3f(0, 1, 0), 0.0f, V3f(sun), 1}};
    list.environment = Environment::constant(V3f(environment));
    list.scene_radius = radius;
    const Lights lights{list};
    double sun_share = 0.0;
    for (int i = 0; i < 1000; ++i) {
      const auto drawn = lights.sample(V3f(0), 0.0f, (i + 0.5f) / 1000.0f, V2f(0.5f));
      if (drawn && drawn->group == 1) sun_share = drawn->pdf_solid_angle;
    }
    return V3d(lights.pdf_sphere(0, V3f(0), 0.0f) / list.spheres[0].pdf_solid_angle(V3f(0)), sun_share,
               environment_share(lights));
  };
  const auto expect_near = [](const V3d& found, const V3d& expected) {
    EXPECT_LT((found - expected).length(), 1e-5) << found << " instead of " << expected;
  };
  // Powers: sphere 4 pi^2 L, sun pi E, environment 4 pi^2 L.
  const float e = 4.0f * std::numbers::pi_v<float>;
  expect_near(shares(1.0f, e, 1.0f), V3d(1, 1, 1) / 3.0);
  expect_near(shares(3.0f, 2.0f * e, 5.0f), V3d(0.3, 0.2, 0.5));
  expect_near(shares(1e-6f, e, 1.0f), V3d(0.1, 0.45, 0.45));
  expect_near(shares(1e-6f, e, 1e30f), V3d(0.1, 0.1, 0.8));
  expect_near(shares(1.0f, 2.0f * e, 16.0f), V3d(0.1, 0.1, 0.8));
  // Raising the first to a tenth pushes the second below it: 4%, 10.1%, 85.9%.
  expect_near(shares(4.0f, 10.1f * e, 85.9f), V3d(0.1, 0.1, 0.8));
  expect_near(shares(0.0f, e, 3.0f), V3d(0, 0.25, 0.75));
  expect_near(shares(1e30f, e, 0.0f), V3d(0.9, 0.1, 0));
  expect_near(shares(1e30f, e, 1e-30f, 0.0f), V3d(1, 1, 1) / 3.0);
}

TEST(Lights, broken_emitters_are_never_chosen) {
  LightList list;
  list.spheres = {{V3f(0, 3, 0), 0.0f, V3f(1.0f), true, 0, {}},
                  {V3f(0, 3, 0), NAN, V3f(1.0f), true, 0, {}},
                  {V3f(0, 3, NAN), 1.0f, V3f(1.0f), true, 0, {}},
                  {V3f(0, 3, 0), INFINITY, V3f(1.0f), true, 0, {}}};
  list.points = {{V3f(0, NAN, 0), V3f(1.0f), 0, {}}, {V3f(0), V3f(0.0f), 0, {}}, {V3f(0), V3f(NAN), 0, {}}};
  list.spots = {{V3f(0), V3f(0), V3f(1.0f), 10.0f, 20.0f, 0, {}},
                {V3f(0), V3f(0, 1, 0), V3f(1.0f), 0.0f, 0.0f, 0, {}},
                {V3f(0), V3f(NAN, 1, 0), V3f(1.0f), 0.0f, 9.0f, 0, {}}};
  list.suns = {
      {V3f(0), 1.0f, V3f(1.0f), 0}, {V3f(0, 1, 0), 1.0f, V3f(0.0f), 0}, {V3f(NAN), 0.0f, V3f(1.0f), 0}};
  EXPECT_TRUE(Lights{list}.empty());
  list.points.push_back({V3f(0, 2, 0), V3f(5.0f), 3, {}});
  const Lights lights{list};
  for (int i = 0; i < 64; ++i) {
    const auto drawn = lights.sample(V3f(0), 0.0f, i / 64.0f, V2f(0.5f));
    ASSERT_TRUE(drawn);
    EXPECT_EQ(drawn->group, 3);
    EXPECT_EQ(drawn->pdf_solid_angle, 1.0f);
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
