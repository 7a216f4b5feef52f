// Sphere lights: samples against the density from far to inside, irradiance against the form factor,
// extremes.
#include "tracer/lights/sphere_light.h"

#include <Imath/ImathMatrixAlgo.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/tracer/shading/light_estimate.h"
#include "tests/tracer/shading/statistics.h"

namespace becalm::tracer {
namespace {

constexpr double kPi = std::numbers::pi;

EmissiveSphere sphere_of(const V3f& center, float radius, bool two_sided = false) {
  return {center, radius, V3f(2.0f), two_sided, 0, {}};
}

/// Half the angle under which the sphere appears.
double angular_radius(const EmissiveSphere& sphere, const V3f& point) {
  return std::asin(sphere.radius / (V3d(sphere.center) - V3d(point)).length());
}

/// Charts the direction to the centre as the pole, and knows by itself where the sphere is seen.
SamplerTest test_sphere(const EmissiveSphere& sphere, const V3f& point, double rim, std::uint32_t seed) {
  const M44d to_pole =
      Imath::rotationMatrix((V3d(sphere.center) - V3d(point)).normalized(), V3d(0.0, 0.0, 1.0));
  Chart chart = sphere_chart(
      [=](TestRandom& random) -> std::optional<V3f> {
        const auto drawn = sphere.sample(point, random.next_2d());
        if (!drawn) return std::nullopt;
        return V3f(transform_vector(V3d(drawn->dir_world), to_pole));
      },
      [=](const V3f& w) {
        return std::atan2(std::hypot(w.x, w.y), w.z) <= rim ? sphere.pdf_solid_angle(point) : 0.0f;
      });
  chart.jumps_y = {rim};
  return test_sampler(chart, seed);
}

TEST(SphereLight, samples_match_their_density_from_outside) {
  const V3f point(0.5f, -2.0f, 1.0f);
  const V3f axis = V3f(0.3f, -0.8f, 0.4f).normalized();
  std::uint32_t seed = 300;
  for (const float distance : {1.00003f, 1.01f, 1.5f, 20.0f}) {  // radii: touching, very near, near, far
    const EmissiveSphere sphere = sphere_of(point + axis * (0.7f * distance), 0.7f);
    const SamplerTest test = test_sphere(sphere, point, angular_radius(sphere, point), ++seed);
    EXPECT_GT(test.result.p_value, sidak_level(0.01, 4)) << distance << ": " << test.replay;
    EXPECT_NEAR(test.integral, 1.0, 1e-3) << distance;
  }
}

TEST(SphereLight, samples_match_their_density_from_inside) {
  std::uint32_t seed = 310;
  for (const float distance : {0.1f, 0.999f}) {
    const EmissiveSphere sphere = sphere_of(V3f(0.3f, distance, -0.2f), 1.0f, true);
    const SamplerTest test = test_sphere(sphere, V3f(0.3f, 0.0f, -0.2f), kPi, ++seed);
    EXPECT_GT(test.result.p_value, sidak_level(0.01, 2)) << distance << ": " << test.replay;
    EXPECT_NEAR(test.integral, 1.0, 1e-3) << distance;
  }
}

TEST(SphereLight, samples_lie_on_the_side_that_is_seen) {
  TestRandom random(7);
  for (int i = 0; i < 20000; ++i) {
    const float distance = 3.0f * random.next();
    const EmissiveSphere sphere = sphere_of(V3f(0, 0, distance), 1.0f, true);
    const auto drawn = sphere.sample(V3f(0), random.next_2d());
    ASSERT_TRUE(drawn) << distance;
    const V3d normal = V3d(drawn->dir_world) * drawn->distance - V3d(sphere.center);
    ASSERT_NEAR(normal.length(), 1.0, 2e-5) << distance;
    const double cosine = normal.dot(V3d(drawn->dir_world));
    // Rounding moves points near the outline across it by no more than their angle to it.
    if (distance > 1.0f) {
      ASSERT_LT(cosine, 1e-3) << distance;
    } else {
      ASSERT_GT(cosine, -1e-3) << distance;
    }
  }
}

TEST(SphereLight, is_not_sampled_from_its_own_surface) {
  TestRandom random(8);
  for (const float away : {0.0f, 100.0f}) {
    const EmissiveSphere sphere = sphere_of(V3f(away, -0.5f * away, 0.25f), 1.0f, true);
    for (int i = 0; i < 1000; ++i) {
      const V3d outward(random.next() - 0.5, random.next() - 0.5, random.next() - 0.5);
      const Receiver at(V3f(V3d(sphere.center) + outward.normalized()), V3f(outward.normalized()));
      ASSERT_FALSE(sphere.sample(at, random.next_2d()));
      ASSERT_EQ(sphere.pdf_solid_angle(at), 0.0f);
      ASSERT_EQ(sphere.irradiance_at(at), 0.0);
      ASSERT_FALSE(sphere.reaches(at));
    }
  }
}

TEST(SphereLight, one_sided_ones_are_dark_inside) {
  const EmissiveSphere sphere = sphere_of(V3f(0.1f, 0, 0), 1.0f);
  EXPECT_EQ(sphere.pdf_solid_angle(V3f(0)), 0.0f);
  EXPECT_FALSE(sphere.sample(V3f(0), V2f(0.3f, 0.6f)));
  EXPECT_NEAR(sphere.radiant_intensity(), kPi * 2.0, 1e-6);
}

/// A sphere wholly above the horizon gives pi L (r/d)^2 cos, whatever its size.
TEST(SphereLight, irradiance_follows_the_form_factor) {
  const V3f point(3.0f, 1.0f, -2.0f);
  const V3f normal(0, 1, 0);
  for (const auto& [offset, radius] :
       {std::pair(V3f(1.0f, 2.0f, -1.0f), 1.5f), std::pair(V3f(0.2f, 1.0f, 0.0f), 0.99f),
        std::pair(V3f(-40.0f, 30.0f, 10.0f), 0.5f), std::pair(V3f(300.0f, 400.0f, 0.0f), 1e-3f)}) {
    const EmissiveSphere sphere = sphere_of(point + offset, radius);
    const V3d to_center = V3d(sphere.center) - V3d(point);
    const double expected = kPi * 2.0 * radius * radius / to_center.length2() * to_center.normalized().y;
    const Estimate found = estimate(41, 50000, [&](TestRandom& random) {
      return irradiance(sphere.sample(point, random.next_2d()), normal);
    });
    EXPECT_NEAR(found.mean, expected, 4.0 * found.error + 1e-5 * expected) << offset;
  }
}

TEST(SphereLight, reaches_whom_it_sends_irradiance) {
  TestRandom random(43);
  int dark = 0;
  for (int i = 0; i < 5000; ++i) {
    const auto place = [&] { return V3f(random.next(), random.next(), random.next()) * 4.0f - V3f(2.0f); };
    const EmissiveSphere sphere = sphere_of(place(), 0.5f, i % 3 == 0);
    const Receiver at(place(), i % 5 == 0 ? V3f(0.0f) : place().normalized());
    ASSERT_EQ(sphere.reaches(at), sphere.irradiance_at(at) > 0.0) << at.position << at.normal;
    dark += sphere.reaches(at) ? 0 : 1;
  }
  EXPECT_GT(dark, 1000);
}

TEST(SphereLight, irradiance_inside_is_that_of_a_uniform_sky) {
  const EmissiveSphere sphere = sphere_of(V3f(0.5f, -0.3f, 0.6f), 1.0f, true);
  const Estimate found = estimate(42, 50000, [&](TestRandom& random) {
    return irradiance(sphere.sample(V3f(0), random.next_2d()), V3f(0, 1, 0));
  });
  EXPECT_NEAR(found.mean, 2.0 * kPi, 4.0 * found.error);
}

TEST(SphereLight, works_at_any_scale_and_distance) {
  for (const float radius : {1e-20f, 1e-12f, 1e-6f, 1.0f, 1e6f, 1e20f}) {
    for (const float gap : {1e-6f, 1e-3f, 1.0f, 1e6f, 1e12f}) {
      // Where floats barely hold the gap beside the radius, the point lies on the sphere.
      const EmissiveSphere sphere = sphere_of(V3f(0, 0, radius + gap), radius);
      const double distance = sphere.center.z;
      const double sine = radius / distance;
      const auto drawn = sphere.sample(V3f(0), V2f(0.4f, 0.7f));
      if (distance - radius <= 0x1p-18 * (distance + radius) || sine < 1e-19) {
        ASSERT_FALSE(drawn) << radius << " " << gap;
        EXPECT_EQ(sphere.pdf_solid_angle(V3f(0)), 0.0f);
        continue;
      }
      ASSERT_TRUE(drawn) << radius << " " << gap;
      EXPECT_EQ(drawn->pdf_solid_angle, sphere.pdf_solid_angle(V3f(0)));
      const double versine_series = sine * sine * (0.5 + sine * sine / 8.0);
      const double versine = sine < 1e-3 ? versine_series : 1.0 - std::sqrt((1.0 - sine) * (1.0 + sine));
      EXPECT_NEAR(drawn->pdf_solid_angle * 2.0 * kPi * versine, 1.0, 1e-5) << radius << " " << gap;
      EXPECT_NEAR(drawn->dir_world.length(), 1.0f, 1e-6f);
      const double nearest = distance - radius, horizon = std::sqrt(nearest * (distance + radius));
      EXPECT_GE(drawn->distance, 0.999999 * nearest) << radius << " " << gap;
      EXPECT_LE(drawn->distance, 1.000001 * horizon) << radius << " " << gap;
    }
  }
}

TEST(SphereLight, directions_fill_a_tiny_outline) {
  // 1e-6 of the distance: 1 - cos is 5e-13, which float would round to 0.
  const EmissiveSphere sphere = sphere_of(V3f(0, 0, 1e6f), 1.0f);
  std::vector<double> observed(10, 0.0);
  constexpr int samples = 20000;
  TestRandom random(12);
  for (int i = 0; i < samples; ++i) {
    const auto drawn = sphere.sample(V3f(0), random.next_2d());
    ASSERT_TRUE(drawn);
    const double sine_squared = V3d(drawn->dir_world).cross(V3d(0, 0, 1)).length2();
    observed[std::min(9, static_cast<int>(sine_squared / 1e-12 * 10.0))] += 1.0;
  }
  const ChiSquare result = chi_square(observed, std::vector<double>(10, samples / 10.0));
  EXPECT_GT(result.p_value, 0.01) << "seed 12 chi^2 " << result.statistic;
}

TEST(SphereLight, what_is_no_sphere_gives_nothing) {
  for (const float radius : {0.0f, -1.0f, NAN}) {
    const EmissiveSphere sphere = sphere_of(V3f(0, 0, 2), radius, true);
    EXPECT_EQ(sphere.radiant_intensity(), 0.0) << radius;
    EXPECT_FALSE(sphere.sample(V3f(0), V2f(0.5f))) << radius;
    EXPECT_EQ(sphere.pdf_solid_angle(V3f(0)), 0.0f) << radius;
  }
  EXPECT_FALSE(sphere_of(V3f(0, NAN, 2), 1.0f, true).sample(V3f(0), V2f(0.5f)));
}

}  // namespace
}  // namespace becalm::tracer
