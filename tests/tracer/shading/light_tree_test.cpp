// The light tree: what it draws against what it says it draws, what it must never pass over, and its worth.
#include "tracer/lights/light_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <span>
#include <vector>

#include "tests/tracer/shading/light_estimate.h"
#include "tests/tracer/shading/statistics.h"
#include "tracer/lights/lights.h"
#include "tracer/sampling/discrete_distribution.h"

namespace becalm::tracer {
namespace {

V3f random_vector(TestRandom& random) {
  const float x = random.next() - 0.5f, y = random.next() - 0.5f;
  return {x, y, random.next() - 0.5f};
}

/// Small lamps of all kinds in a room of 20 x 5 x 20, of powers over two decades, facing anywhere; each of
/// its own group.
LightList lamps(int of_each, std::uint32_t seed) {
  TestRandom random(seed);
  LightList list;
  std::uint16_t group = 0;
  const auto place = [&] {
    const V3f p = random_vector(random);
    return V3f(20.0f * p.x, 5.0f * p.y + 2.5f, 20.0f * p.z);
  };
  const auto radiance = [&] { return V3f(std::pow(100.0f, random.next())); };
  for (int i = 0; i < of_each; ++i) {
    const V3f p = place(), e1 = random_vector(random) * 0.3f, e2 = random_vector(random) * 0.3f;
    const bool two_sided = i % 3 == 0;
    list.triangles.push_back({p, p + e1, p + e2, radiance(), two_sided, group++, {}});
    list.spheres.push_back({place(), 0.1f * random.next(), radiance(), false, group++, {}});
    list.points.push_back({place(), radiance() * 0.01f, group++, {}});
    const V3f at = place(), to = random_vector(random);
    const float outer = 180.0f * random.next();
    list.spots.push_back({at, to, radiance() * 0.01f, 0.5f * outer, outer, group++, {}});
  }
  return list;
}

LightBounds point_bounds(const V3d& position, double intensity) {
  LightBounds bounds;
  bounds.box.extendBy(position);
  bounds.intensity = intensity;
  return bounds;
}

TEST(LightTree, draws_with_the_probabilities_it_reports) {
  TestRandom random(700);
  std::vector<LightBounds> emitters;
  for (int i = 0; i < 200; ++i) {
    LightBounds bounds = point_bounds(V3d(random_vector(random)) * 10.0, i % 7 == 0 ? 0.0 : 1.0 + i % 5);
    bounds.box.extendBy(bounds.box.min + V3d(random_vector(random)));
    bounds.facing = {V3d(random_vector(random)).normalized(), 0.0};
    bounds.two_sided = i % 4 == 0;
    emitters.push_back(bounds);
  }
  const LightTree tree(emitters);
  for (const V3f& point : {V3f(0.0f), V3f(4, -3, 2), V3f(40, 0, 10)}) {
    std::vector<double> observed(emitters.size() + 1, 0.0), expected(emitters.size() + 1, 0.0);
    constexpr int samples = 100000;
    double whole = 0.0;
    for (std::size_t i = 0; i < emitters.size(); ++i) {
      expected[i] = samples * static_cast<double>(tree.probability(i, point));
      whole += expected[i];
    }
    ASSERT_LT(whole, samples * (1.0 + 1e-5));
    expected.back() = samples - whole;  // dead ends
    for (int i = 0; i < samples; ++i) {
      const auto choice = tree.sample(point, random.next());
      if (choice) {
        ASSERT_EQ(choice->probability, tree.probability(choice->index, point));
      }
      observed[choice ? choice->index : emitters.size()] += 1.0;
    }
    const ChiSquare result = chi_square(observed, expected);
    EXPECT_GT(result.p_value, sidak_level(0.01, 3))
        << "seed 700 chi^2 " << result.statistic << " at " << point;
  }
}

TEST(LightTree, is_monotone_in_u) {
  TestRandom random(710);
  std::vector<LightBounds> emitters;
  for (int i = 0; i < 60; ++i) emitters.push_back(point_bounds(V3d(random_vector(random)), 1.0));
  const LightTree tree(emitters);
  // Each emitter owns one interval: it never comes back after another.
  std::set<std::size_t> closed;
  std::size_t current = emitters.size();
  for (int i = 0; i <= 100000; ++i) {
    const auto choice = tree.sample(V3f(0.1f, 0.2f, -0.4f), i / 100000.0f);
    ASSERT_TRUE(choice);
    if (choice->index == current) continue;
    EXPECT_TRUE(closed.insert(current).second);
    current = choice->index;
  }
  EXPECT_EQ(closed.size(), emitters.size());
}

TEST(LightTree, passes_over_nothing_that_shines) {
  const LightList list = lamps(60, 720);
  const Lights lights{list};
  TestRandom random(721);
  int shining = 0;
  for (int i = 0; i < 300; ++i) {
    const V3f p = random_vector(random);
    const V3f point(30.0f * p.x, 10.0f * p.y, 30.0f * p.z);
    const Receiver surface(point, random_vector(random).normalized());
    for (std::size_t k = 0; k < list.triangles.size(); ++k) {
      const auto drawn = AreaLight(list.triangles[k]).sample(point, random.next_2d());
      if (!drawn) continue;
      ++shining;
      ASSERT_GT(lights.pdf_triangle(k, lights.received(point, 0.0f), drawn->dir_world, drawn->distance), 0.0f)
          << k << point;
      if (drawn->dir_world.dot(surface.normal) < 1e-3f) continue;
      ASSERT_GT(lights.pdf_triangle(k, lights.received(surface, 0.0f), drawn->dir_world, drawn->distance),
                0.0f)
          << k << point << surface.normal;
    }
    for (std::size_t k = 0; k < list.spheres.size(); ++k) {
      if (list.spheres[k].radiant_intensity() > 0.0 && list.spheres[k].pdf_solid_angle(point) > 0.0f) {
        ASSERT_GT(lights.pdf_sphere(k, lights.received(point, 0.0f)), 0.0f) << k << point;
      }
    }
  }
  EXPECT_GT(shining, 1000);
}

/// By the tree and light by light: the same irradiance, and each light its own part of it.
TEST(LightTree, irradiance_is_the_sum_of_the_lights) {
  LightList list = lamps(10, 730);
  list.suns = {{V3f(1, 2, 0), 0.0f, V3f(0.5f), 900}};
  Image sky(4, 2, 1);
  for (int x = 0; x < 4; ++x) sky.at(x, 0, 0) = 0.1f;
  list.environment = Environment::image(sky, 1.0f, 0.0f);
  list.environment_group = 901;
  const Lights lights{list};
  const V3f point(1.0f, 0.1f, -2.0f), up(0, 1, 0);
  const Estimate from_sky = estimate(733, 100000, [&](TestRandom& r) {
    const auto drawn = list.environment->sample(point, r.next_2d());
    return list.environment->radiance(drawn->dir_world).x * std::max(0.0f, drawn->dir_world.y) /
           drawn->pdf_solid_angle;
  });
  double exact = 0.5 * up.dot(V3f(1, 2, 0).normalized()) + from_sky.mean;
  TestRandom random(731);
  const auto mean_of = [&](const auto& light) {
    double sum = 0.0;
    constexpr int samples = 2000;
    for (int i = 0; i < samples; ++i) sum += irradiance(light.sample(point, random.next_2d()), up) / samples;
    return sum;
  };
  for (const EmissiveTriangle& triangle : list.triangles) exact += mean_of(AreaLight(triangle));
  for (const EmissiveSphere& sphere : list.spheres) exact += mean_of(sphere);
  for (const PointLight& light : list.points) exact += irradiance(light.sample(point), up);
  for (const SpotLight& light : list.spots) exact += irradiance(SpotEmitter(light).sample(point), up);
  const Estimate whole = estimate(732, 200000, [&](TestRandom& r) {
    const float u_light = r.next();
    return irradiance(lights.sample(lights.received(point, 0.0f), u_light, r.next_2d()), up);
  });
  EXPECT_NEAR(whole.mean, exact, 4.0 * whole.error + 1e-3 * exact);
  EXPECT_LT(whole.error, 0.01 * whole.mean);
  // Densities agree with the samples through the tree as well.
  for (int i = 0; i < 20000; ++i) {
    const float u_light = random.next();
    const auto drawn = lights.sample(lights.received(point, 0.0f), u_light, random.next_2d());
    if (!drawn || drawn->group >= 900) continue;
    const std::size_t k = drawn->group / 4;
    if (drawn->group % 4 == 0) {
      ASSERT_EQ(drawn->pdf_solid_angle,
                lights.pdf_triangle(k, lights.received(point, 0.0f), drawn->dir_world, drawn->distance));
    } else if (drawn->group % 4 == 1) {
      ASSERT_EQ(drawn->pdf_solid_angle, lights.pdf_sphere(k, lights.received(point, 0.0f)));
    } else {
      ASSERT_TRUE(drawn->delta);
    }
  }
}

TEST(LightTree, moving_emitters_stay_in_reach) {
  LightList list = lamps(10, 740);
  list.triangle_keys = {{V3f(-9, 3, 0), V3f(-8.8f, 3, 0), V3f(-9, 3, 0.2f)},
                        {V3f(9, 3, 0), V3f(9, 3, 0.2f), V3f(9.2f, 3, 0)}};  // turns over on the way
  list.triangles.push_back({V3f(0), V3f(0), V3f(0), V3f(50.0f), true, 500, {0, 1}});
  const Lights lights{list};
  const V3f point(8.9f, 0.0f, 0.1f);
  for (const float time : {0.0f, 0.3f, 1.0f}) {
    TestRandom random(741);
    int found = 0;
    for (int i = 0; i < 20000; ++i) {
      const float u_light = random.next();
      const auto drawn = lights.sample(lights.received(point, time), u_light, random.next_2d());
      if (!drawn || drawn->group != 500) continue;
      ++found;
      ASSERT_EQ(drawn->pdf_solid_angle,
                lights.pdf_triangle(list.triangles.size() - 1, lights.received(point, time), drawn->dir_world,
                                    drawn->distance));
    }
    EXPECT_GT(found, 0) << time;
  }
}

/// A thousand small lamps: how much of the variance of choosing by power is left.
TEST(LightTree, beats_the_choice_by_power) {
  const LightList list = lamps(1000, 750);
  std::vector<AreaLight> lights(list.triangles.begin(), list.triangles.end());
  std::vector<double> powers;
  std::vector<LightBounds> bounds;
  for (const AreaLight& light : lights) {
    powers.push_back(light.radiant_intensity());
    LightBounds& b = bounds.emplace_back(point_bounds(V3d(light.p0), light.radiant_intensity()));
    b.box.extendBy(V3d(light.p0 + light.edge1));
    b.box.extendBy(V3d(light.p0 + light.edge2));
    b.facing = {V3d(light.normal), 0.0};
    b.two_sided = light.two_sided;
  }
  const DiscreteDistribution by_power(powers);
  const LightTree tree(bounds);
  TestRandom random(751);
  double by_power_variance = 0.0, tree_variance = 0.0;
  for (int i = 0; i < 20; ++i) {
    const V3f p = random_vector(random);
    const V3f point(18.0f * p.x, 0.0f, 18.0f * p.z), up(0, 1, 0);
    const Estimate a = estimate(760 + i, 5000, [&](TestRandom& r) {
      const auto choice = by_power.sample(r.next());
      return irradiance(lights[choice.index].sample(point, r.next_2d()), up) / choice.probability;
    });
    const Estimate b = estimate(760 + i, 5000, [&](TestRandom& r) {
      const auto choice = tree.sample(point, r.next());
      return choice ? irradiance(lights[choice->index].sample(point, r.next_2d()), up) / choice->probability
                    : 0.0;
    });
    EXPECT_NEAR(a.mean, b.mean, 4.5 * std::hypot(a.error, b.error)) << point;
    by_power_variance += a.error * a.error / (b.mean * b.mean);
    tree_variance += b.error * b.error / (b.mean * b.mean);
  }
  EXPECT_LT(tree_variance, 0.5 * by_power_variance);
}

TEST(LightTree, degenerate_sets) {
  EXPECT_TRUE(LightTree(std::span<const LightBounds>()).empty());
  const std::vector<LightBounds> dark = {point_bounds(V3d(0.0), 0.0)};
  EXPECT_TRUE(LightTree(dark).empty());
  const std::vector<LightBounds> one = {point_bounds(V3d(0.0), 0.0), point_bounds(V3d(1.0), 1e-30)};
  EXPECT_EQ(LightTree(one).sample(V3f(0), 0.5f)->index, 1u);
  EXPECT_EQ(LightTree(one).probability(1, V3f(0)), 1.0f);
  EXPECT_EQ(LightTree(one).probability(0, V3f(0)), 0.0f);
  // Powers from 1e-30 to 1e30, all in one place, or in steps of ten each: deep and uneven trees.
  for (const bool in_one_place : {true, false}) {
    std::vector<LightBounds> emitters;
    for (int i = 0; i < 121; ++i) {
      const double place = in_one_place ? 3.0 : std::pow(10.0, 0.25 * i - 15.0);
      emitters.push_back(point_bounds(V3d(place, 0.0, 0.0), std::pow(10.0, 0.5 * i - 30.0)));
    }
    const LightTree tree(emitters);
    for (const V3f& point : {V3f(3, 0, 0), V3f(0), V3f(1e-15f, 1e-20f, 0), V3f(1e15f)}) {
      double sum = 0.0;
      for (std::size_t i = 0; i < emitters.size(); ++i) {
        const float probability = tree.probability(i, point);
        ASSERT_TRUE(probability >= 0.0f && probability <= 1.0f) << i << point;
        sum += probability;
      }
      EXPECT_NEAR(sum, 1.0, 1e-5) << point;
      // u = 0 may lead to an emitter whose probability float does not hold: then it is not drawn.
      for (const float u : {0.0f, 0.5f, 0x1.fffffep-1f, 1.0f}) {
        const auto choice = tree.sample(point, u);
        ASSERT_TRUE(choice || u == 0.0f) << u << point;
        if (choice) {
          EXPECT_EQ(choice->probability, tree.probability(choice->index, point));
        }
      }
    }
  }
}

}  // namespace
}  // namespace becalm::tracer
