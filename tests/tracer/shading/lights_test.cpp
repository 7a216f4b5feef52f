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

Lights lights_of(std::vector<EmissiveTriangle> triangles, std::optional<Environment> environment = {}) {
  LightList list;
  list.triangles = std::move(triangles);
  list.environment = std::move(environment);
  return Lights(std::move(list));
}

/// A sky that is bright in one quarter.
Environment uneven_sky(float radiance) {
  Image image(8, 4, 1, 0.1f);
  for (int x = 0; x < 2; ++x) image.at(x, 1, 0) = 4.0f;
  return Environment::image(image, radiance, 0.0f);
}

/// Density with which the environment finds the direction; 0 without one.
float pdf_environment(const Lights& lights, const Receiver& at, const V3f& dir) {
  float found = 0.0f;
  lights.for_each_infinite(
      dir, [&](const V3f&, std::uint16_t, const auto& pdf) { found = pdf(lights.received(at, 0.0f)); });
  return found;
}

/// Which triangle a sample came from, by its radiance; triangles.size() for the environment.
std::size_t source(const std::vector<EmissiveTriangle>& triangles, const LightSample& drawn) {
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (drawn.radiance == triangles[i].radiance) return i;
  }
  return triangles.size();
}

TEST(Lights, chosen_by_what_they_send_with_matching_densities) {
  const std::vector<EmissiveTriangle> triangles = {facing_down(-2, 1.0f), facing_down(0, 5.0f),
                                                   facing_down(2, 4.0f)};
  const Lights lights = lights_of(triangles);
  for (const Receiver& at : {Receiver(V3f(0.2f, 0.0f, 0.3f)), Receiver(V3f(0.2f, 0.0f, 0.3f), V3f(0, 1, 0)),
                             Receiver(V3f(-3, 0.5f, 2), V3f(0.8f, 0.6f, 0))}) {
    const Lights::Received received = lights.received(at, 0.0f);
    TestRandom random(21);
    std::vector<double> observed(3, 0.0), expected(3, 0.0);
    constexpr int samples = 40000;
    for (int i = 0; i < samples; ++i) {
      const float u_light = random.next();
      const auto drawn = lights.sample(received, u_light, random.next_2d());
      ASSERT_TRUE(drawn);
      const std::size_t index = source(triangles, *drawn);
      observed.at(index) += 1.0;
      ASSERT_EQ(drawn->pdf_solid_angle,
                lights.pdf_triangle(index, received, drawn->dir_world, drawn->distance));
    }
    double all = 0.0;
    for (const EmissiveTriangle& triangle : triangles) all += AreaLight(triangle).irradiance_at(at);
    for (std::size_t i = 0; i < 3; ++i)
      expected[i] = samples * AreaLight(triangles[i]).irradiance_at(at) / all;
    const ChiSquare result = chi_square(observed, expected);
    EXPECT_GT(result.p_value, sidak_level(0.01, 3)) << "seed 21 chi^2 " << result.statistic;
  }
}

const V3f kUp(0, 1, 0);
const V3f kBelow(0.2f, 0.0f, 0.3f);

/// The probability with which the environment is chosen.
double environment_share(const Lights& lights, const Environment& environment, const Receiver& at) {
  return pdf_environment(lights, at, kUp) / environment.look(kUp).pdf_solid_angle(at);
}

TEST(Lights, an_even_environment_is_left_to_material_samples_where_other_lights_shine) {
  const Environment even = Environment::constant(V3f(2.0f));
  const Lights lights = lights_of({facing_down(0, 1.0f)}, even);
  EXPECT_EQ(environment_share(lights, even, kBelow), 0.0);
  EXPECT_EQ(environment_share(lights, even, Receiver(kBelow, kUp)), 0.0);
  // Above the lamp, and turned away from it.
  EXPECT_EQ(environment_share(lights, even, V3f(0, 2, 0)), 1.0);
  EXPECT_EQ(environment_share(lights, even, Receiver(V3f(0, 2, 0), kUp)), 1.0);
  EXPECT_EQ(lights.pdf_triangle(0, lights.received(Receiver(kBelow, -kUp), 0.0f), kUp, 1.0f), 0.0f);
}

TEST(Lights, an_uneven_environment_is_chosen_by_its_irradiance) {
  const auto share = [](float radiance, float lamp) {
    const Environment sky = uneven_sky(radiance);
    return environment_share(lights_of({facing_down(0, lamp)}, sky), sky, Receiver(kBelow, kUp));
  };
  EXPECT_GT(share(1.0f, 1.0f), share(0.2f, 1.0f));
  EXPECT_GT(share(0.2f, 1.0f), share(0.04f, 1.0f));
  EXPECT_NEAR(share(1.0f, 1.0f), share(1e-10f, 1e-10f), 1e-5);
  EXPECT_GT(share(1e-9f, 1.0f), 0.01);
  EXPECT_GT(share(1e6f, 1.0f), 0.9);
  EXPECT_LT(share(1e6f, 1.0f), 1.0);
  EXPECT_NEAR(share(1.0f, 0.0f), 1.0, 1e-6);
}

TEST(Lights, a_far_wider_scene_changes_nothing) {
  const EmissiveTriangle lamp = facing_down(0, 1.0f);
  const Environment sky = uneven_sky(0.1f);
  const Receiver at(kBelow, kUp);
  const double alone = environment_share(lights_of({lamp}, sky), sky, at);
  EmissiveTriangle far = lamp;
  far.p0 += V3f(1e6f, 0, 0), far.p1 += V3f(1e6f, 0, 0), far.p2 += V3f(1e6f, 0, 0);
  EXPECT_NEAR(environment_share(lights_of({lamp, far}, sky), sky, at), alone, 1e-6);
}

TEST(Lights, the_only_kind_takes_all) {
  const Environment even = Environment::constant(V3f(2.0f));
  for (const Receiver& at : {Receiver(kBelow), Receiver(kBelow, kUp)}) {
    EXPECT_EQ(environment_share(lights_of({}, even), even, at), 1.0);
    EXPECT_EQ(environment_share(lights_of({facing_down(0, 0.0f)}, even), even, at), 1.0);
  }
}

TEST(Lights, two_triangles_of_a_rectangle_are_sampled_as_one) {
  const std::vector<EmissiveTriangle> halves = {{V3f(-1, 1, -1), V3f(1, 1, -1), V3f(1, 1, 1), V3f(3.0f)},
                                                {V3f(-1, 1, -1), V3f(1, 1, 1), V3f(-1, 1, 1), V3f(3.0f)}};
  const Lights lights = lights_of(halves);
  const Lights::Received received = lights.received(Receiver(V3f(0), kUp), 0.0f);
  TestRandom random(78);
  for (int i = 0; i < 1000; ++i) {
    const auto drawn = lights.sample(received, random.next(), random.next_2d());
    ASSERT_TRUE(drawn);
    // Whichever of the halves a ray hits.
    for (const std::size_t half : {0, 1})
      ASSERT_NEAR(
          lights.pdf_triangle(half, received, drawn->dir_world, drawn->distance) / drawn->pdf_solid_angle,
          1.0f, 1e-4f);
  }
}

TEST(Lights, nothing_to_sample) {
  const EmissiveTriangle flat = {V3f(0), V3f(1, 0, 0), V3f(2, 0, 0), V3f(1e30f), true};
  for (const Lights& lights : {Lights(), lights_of({}), lights_of({flat}),
                               lights_of({facing_down(0, 0.0f)}, Environment::constant(V3f(0.0f)))}) {
    EXPECT_TRUE(lights.empty());
    EXPECT_FALSE(lights.sample(lights.received(V3f(0), 0.0f), 0.5f, V2f(0.5f)));
    EXPECT_EQ(pdf_environment(lights, V3f(0), V3f(0, 1, 0)), 0.0f);
  }
}

TEST(Lights, degenerate_triangles_are_never_chosen) {
  const EmissiveTriangle flat = {V3f(0), V3f(1, 0, 0), V3f(2, 0, 0), V3f(1e30f), true};
  EmissiveTriangle broken = facing_down(0, 1.0f);
  broken.radiance.y = NAN;
  const std::vector<EmissiveTriangle> triangles = {flat, facing_down(0, 2.0f), broken, flat};
  const Lights lights = lights_of(triangles);
  for (int i = 0; i <= 64; ++i) {
    const auto drawn = lights.sample(lights.received(V3f(0.2f, 0, 0.2f), 0.0f),
                                     std::min(i / 64.0f, 0x1.fffffep-1f), V2f(0.4f, 0.3f));
    ASSERT_TRUE(drawn);
    EXPECT_EQ(drawn->radiance, V3f(2.0f));
  }
  EXPECT_EQ(lights.pdf_triangle(0, lights.received(V3f(0), 0.0f), V3f(0, 1, 0), 1.0f), 0.0f);
  EXPECT_EQ(lights.pdf_triangle(2, lights.received(V3f(0), 0.0f), V3f(0, 1, 0), 1.0f), 0.0f);
}

TEST(Lights, extreme_radiances_stay_finite) {
  const std::vector<EmissiveTriangle> triangles = {facing_down(0, 1e30f), facing_down(2, 1e-30f)};
  const Lights lights = lights_of(triangles, uneven_sky(1e30f));
  TestRandom random(8);
  for (int i = 0; i < 1000; ++i) {
    const float u_light = random.next();
    const auto drawn = lights.sample(lights.received(V3f(0.2f, 0, 0.2f), 0.0f), u_light, random.next_2d());
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
  list.environment = uneven_sky(0.125f);
  list.environment_group = 17;
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
    const auto drawn = lights.sample(lights.received(point, 0.0f), u_light, random.next_2d());
    ASSERT_TRUE(drawn);
    ++seen.at(drawn->group);
    ASSERT_EQ(drawn->delta, drawn->group == 13 || drawn->group == 14 || drawn->group == 16);
    ASSERT_EQ(std::isinf(drawn->distance), drawn->group >= 15);
    if (drawn->delta && seen[drawn->group] == 1) share_of_deltas += drawn->pdf_solid_angle;
    if (drawn->group == 11) {
      ASSERT_EQ(drawn->pdf_solid_angle,
                lights.pdf_triangle(0, lights.received(point, 0.0f), drawn->dir_world, drawn->distance));
    } else if (drawn->group == 12) {
      ASSERT_EQ(drawn->pdf_solid_angle, lights.pdf_sphere(0, lights.received(point, 0.0f)));
    } else if (drawn->group == 15 || drawn->group == 17) {
      lights.for_each_infinite(
          drawn->dir_world, [&](const V3f& radiance, std::uint16_t group, const auto& pdf) {
            if (group != drawn->group) return;
            // Rounding may move a direction across the border of a texel.
            if (group == 17 && radiance != drawn->radiance) return;
            ASSERT_NEAR(pdf(lights.received(point, 0.0f)) / drawn->pdf_solid_angle, 1.0f, 1e-4f);
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
    lights.for_each_infinite(dir.normalized(), [&](const V3f& radiance, std::uint16_t group, const auto&) {
      found.emplace_back(group, radiance.x);
    });
    return found;
  };
  const double sine = std::sin(5.0 * std::numbers::pi / 180.0);
  const auto in_disc = groups(V3f(1, 1.05f, 0));
  ASSERT_EQ(in_disc.size(), 2u);
  EXPECT_EQ(in_disc[0].first, 17);
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
      return irradiance(lights.sample(lights.received(point, 0.0f), u_light, random.next_2d()), up);
    });
  };
  for (std::uint32_t i = 0; i < alone.size(); ++i) {
    const Estimate part = found_by(Lights{alone[i]}, 50 + i);
    expected += part.mean;
    error += part.error * part.error;
  }
  const Estimate whole = found_by(Lights{list}, 60);
  EXPECT_NEAR(whole.mean, expected, 4.0 * std::sqrt(error + whole.error * whole.error));
  EXPECT_LT(whole.error, 0.02 * whole.mean);
}

TEST(Lights, no_kind_is_starved) {
  // Shares of the sun (a delta: its pdf), the sphere and the environment.
  const auto shares = [](float sphere, float sun, float environment) {
    LightList list;
    list.spheres = {{V3f(0, 3, 0), 1.0f, V3f(sphere), false, 0, {}}};
    list.suns = {{V3f(0, 1, 0), 0.0f, V3f(sun), 1}};
    list.environment = uneven_sky(environment);
    const Lights lights{list};
    const Receiver at(V3f(0), kUp);
    const Lights::Received received = lights.received(at, 0.0f);
    double sun_share = 0.0;
    for (int i = 0; i < 1000; ++i) {
      const auto drawn = lights.sample(received, (i + 0.5f) / 1000.0f, V2f(0.5f));
      if (drawn && drawn->group == 1) sun_share = drawn->pdf_solid_angle;
    }
    return V3d(lights.pdf_sphere(0, received) / list.spheres[0].pdf_solid_angle(at), sun_share,
               environment_share(lights, *list.environment, at));
  };
  for (const V3d& share : {shares(1, 1, 1), shares(1e-6f, 1, 1), shares(1, 1e-6f, 1e30f),
                           shares(1, 1, 1e-30f), shares(1e30f, 1e-30f, 1)}) {
    EXPECT_NEAR(share.x + share.y + share.z, 1.0, 1e-5) << share;
    EXPECT_GE(share.x, 0.0499) << share;
    EXPECT_GE(share.y, 0.0499) << share;
    EXPECT_GE(share.z, 0.01) << share;  // less in proportion to its unevenness
  }
  // The irradiance of the sphere is pi / 9.
  const V3d equal = shares(1.0f, std::numbers::pi_v<float> / 9.0f, 1e-30f);
  EXPECT_NEAR(equal.x, equal.y, 1e-5);
  EXPECT_EQ(shares(0, 1, 1).x, 0.0);
  EXPECT_EQ(shares(1, 0, 1).y, 0.0);
}

TEST(Lights, each_of_several_suns_is_chosen_by_its_irradiance) {
  LightList list;
  for (int i = 0; i < 4; ++i) {
    list.suns.push_back({V3f(0.3f * i, 1, 0), 0.0f, V3f(1.0f + i), static_cast<std::uint16_t>(i)});
  }
  const Lights lights{list};
  const Lights::Received received = lights.received(V3f(0), 0.0f);
  TestRandom random(32);
  constexpr int samples = 100000;
  std::vector<int> seen(4, 0);
  for (int i = 0; i < samples; ++i) {
    const auto drawn = lights.sample(received, random.next(), V2f(0.5f));
    ASSERT_TRUE(drawn);
    ++seen.at(drawn->group);
    ASSERT_NEAR(drawn->pdf_solid_angle, (1.0 + drawn->group) / 10.0, 1e-6);
  }
  for (int i = 0; i < 4; ++i) {
    const double share = (1.0 + i) / 10.0;
    EXPECT_NEAR(seen[i], samples * share, 5.0 * std::sqrt(samples * share * (1.0 - share)))
        << "seed 32 " << i;
  }
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
    const auto drawn = lights.sample(lights.received(V3f(0), 0.0f), i / 64.0f, V2f(0.5f));
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
    const auto drawn = lights.sample(lights.received(V3f(0), 0.0f), u_light, random.next_2d());
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
