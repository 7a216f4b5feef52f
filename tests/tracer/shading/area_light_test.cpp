// Triangle lights: samples against the density, its integral against the exact solid angle, and the extremes.
#include "tracer/lights/area_light.h"

#include <Imath/ImathMatrixAlgo.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/tracer/shading/light_estimate.h"
#include "tests/tracer/shading/statistics.h"

namespace becalm::tracer {
namespace {

/// Van Oosterom and Strackee, 1983.
double solid_angle(const V3d& a, const V3d& b, const V3d& c) {
  const double numerator = std::abs(a.dot(b.cross(c)));
  const double denominator = a.length() * b.length() * c.length() + a.dot(b) * c.length() +
                             b.dot(c) * a.length() + c.dot(a) * b.length();
  return 2.0 * std::atan2(numerator, denominator);
}

/// Faces down to the points below it.
const EmissiveTriangle kCeiling = {V3f(-1, 2, -1), V3f(1, 2, -1), V3f(0.2f, 2.5f, 1.5f), V3f(3, 2, 1), false};

TEST(AreaLight, samples_are_uniform_by_area_from_afar) {
  const AreaLight light(kCeiling);
  const V3f point(3.0f, -60.0f, 4.0f);
  // In barycentric coordinates of p1 and p2 the density is 2 on a triangle; compared over the unit square by
  // counts.
  constexpr int grid = 12;
  std::vector<double> observed(grid * grid, 0.0);
  std::vector<double> expected(grid * grid, 0.0);
  constexpr int samples = 100000;
  TestRandom random(17);
  const V3d normal = V3d(light.edge1).cross(V3d(light.edge2));
  for (int i = 0; i < samples; ++i) {
    const auto drawn = light.sample(point, random.next_2d());
    ASSERT_TRUE(drawn);
    const V3d offset = V3d(point) + V3d(drawn->dir_world) * drawn->distance - V3d(light.p0);
    const double b1 = offset.cross(V3d(light.edge2)).dot(normal) / normal.length2();
    const double b2 = V3d(light.edge1).cross(offset).dot(normal) / normal.length2();
    ASSERT_GT(b1, -1e-4);  // directions and distances are rounded
    ASSERT_GT(b2, -1e-4);
    ASSERT_LT(b1 + b2, 1.0 + 1e-4);
    const int x = std::clamp(static_cast<int>(b1 * grid), 0, grid - 1);
    const int y = std::clamp(static_cast<int>(b2 * grid), 0, grid - 1);
    observed[y * grid + x] += 1.0;
  }
  for (int y = 0; y < grid; ++y) {
    for (int x = 0; x + y < grid; ++x) {
      expected[y * grid + x] = samples * (x + y == grid - 1 ? 1.0 : 2.0) / (grid * grid);
    }
  }
  // Rounding may put a sample on the diagonal one cell too far: those cells expect nothing and are pooled.
  const ChiSquare result = chi_square(observed, expected);
  EXPECT_GT(result.p_value, 0.01) << "seed 17 chi^2 " << result.statistic;
}

TEST(AreaLight, density_is_per_solid_angle) {
  const AreaLight light(kCeiling);
  for (const V3f& point : {V3f(0.3f, -0.2f, 0.4f), V3f(5, -3, 2), V3f(0, 1.9f, -0.5f), V3f(30, -60, 20)}) {
    // E[1 / pdf] over the samples is the solid angle.
    TestRandom random(5);
    double sum = 0.0;
    double squares = 0.0;
    constexpr int samples = 100000;
    for (int i = 0; i < samples; ++i) {
      const auto drawn = light.sample(point, random.next_2d());
      ASSERT_TRUE(drawn);
      ASSERT_EQ(drawn->pdf_solid_angle, light.pdf_solid_angle(point, drawn->dir_world, drawn->distance));
      const double value = 1.0 / drawn->pdf_solid_angle;
      sum += value;
      squares += value * value;
    }
    const double mean = sum / samples;
    const double error = std::sqrt(std::max(0.0, squares / samples - mean * mean) / samples);
    const V3d p(point);
    EXPECT_NEAR(mean, solid_angle(V3d(kCeiling.p0) - p, V3d(kCeiling.p1) - p, V3d(kCeiling.p2) - p),
                4 * error + 1e-6 * mean)
        << point;
  }
}

TEST(AreaLight, shines_to_one_side_or_both) {
  EmissiveTriangle triangle = kCeiling;
  const V3f above(0, 5, 0);
  EXPECT_TRUE(AreaLight(triangle).sample(V3f(0, 0, 0), V2f(0.3f, 0.4f)));
  EXPECT_FALSE(AreaLight(triangle).sample(above, V2f(0.3f, 0.4f)));
  triangle.two_sided = true;
  EXPECT_TRUE(AreaLight(triangle).sample(above, V2f(0.3f, 0.4f)));
  EXPECT_GT(AreaLight(triangle).irradiance_at(above), 0.0);
  EXPECT_EQ(AreaLight(kCeiling).irradiance_at(above), 0.0);
}

TEST(AreaLight, degenerate_triangles_give_nothing) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  for (const V3f& p2 : {V3f(2, 0, 0), V3f(0, 0, 0), V3f(nan, 0, 0), V3f(INFINITY, 1, 0)}) {
    const AreaLight light(EmissiveTriangle{V3f(0, 0, 0), V3f(1, 0, 0), p2, V3f(1), true});
    EXPECT_EQ(light.area, 0.0) << p2;
    EXPECT_EQ(light.radiant_intensity(), 0.0) << p2;
    EXPECT_EQ(light.irradiance_at(V3f(0, 0, 1)), 0.0) << p2;
    EXPECT_EQ(light.pdf_solid_angle(V3f(0, 0, 1), V3f(0, 0, -1), 1.0f), 0.0f) << p2;
    EXPECT_FALSE(light.sample(V3f(0, 0, 1), V2f(0.5f))) << p2;
  }
}

TEST(AreaLight, works_at_any_scale) {
  for (const float scale : {1e-12f, 1e-4f, 1.0f, 1e6f, 1e12f}) {
    const EmissiveTriangle triangle = {kCeiling.p0 * scale, kCeiling.p1 * scale, kCeiling.p2 * scale,
                                       V3f(1e30f), false};
    const auto unit = AreaLight(kCeiling).sample(V3f(0, 0, 0), V2f(0.2f, 0.7f));
    const auto scaled = AreaLight(triangle).sample(V3f(0, 0, 0), V2f(0.2f, 0.7f));
    ASSERT_TRUE(unit && scaled) << scale;
    EXPECT_NEAR(scaled->pdf_solid_angle / unit->pdf_solid_angle, 1.0f, 1e-5f) << scale;
    EXPECT_TRUE(std::isfinite(AreaLight(triangle).radiant_intensity())) << scale;
    EXPECT_TRUE(std::isfinite(AreaLight(triangle).irradiance_at(V3f(0)))) << scale;
  }
}

TEST(AreaLight, point_on_the_light_gives_nothing) {
  const AreaLight light(EmissiveTriangle{V3f(0, 0, 0), V3f(1, 0, 0), V3f(0, 1, 0), V3f(1), true});
  TestRandom random(1);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(light.sample(V3f(0.25f, 0.25f, 0.0f), random.next_2d()));
  EXPECT_FALSE(light.sample(V3f(0, 0, 0), V2f(1.0f, 1.0f)));
}

/// Tests the samples of `light` against its density where that is not 0, charted around the direction `pole`.
SamplerTest test_light(const AreaLight& light, const Receiver& at, std::uint32_t seed) {
  const auto distance = [=](const V3f& dir) {
    return V3d(light.normal).dot(V3d(light.p0) - V3d(at.position)) / V3d(light.normal).dot(V3d(dir));
  };
  const V3d center = V3d(light.p0) + (V3d(light.edge1) + V3d(light.edge2)) * (light.quad ? 0.5 : 1.0 / 3.0);
  const M44d to_pole = Imath::rotationMatrix((center - V3d(at.position)).normalized(), V3d(0.0, 0.0, 1.0));
  const M44d from_pole = to_pole.transposed();
  const auto hits = [=](const V3f& dir) {
    const double t = distance(dir);
    if (!(t > 0.0)) return false;
    const V3d offset = V3d(at.position) + V3d(dir) * t - V3d(light.p0);
    const V3d n = V3d(light.edge1).cross(V3d(light.edge2));
    const double b1 = offset.cross(V3d(light.edge2)).dot(n) / n.length2();
    const double b2 = V3d(light.edge1).cross(offset).dot(n) / n.length2();
    return b1 >= 0.0 && b2 >= 0.0 && (light.quad ? b1 <= 1.0 && b2 <= 1.0 : b1 + b2 <= 1.0);
  };
  return test_sampler(
      sphere_chart(
          [=](TestRandom& random) -> std::optional<V3f> {
            const auto drawn = light.sample(at, random.next_2d());
            if (!drawn) return std::nullopt;
            return V3f(transform_vector(V3d(drawn->dir_world), to_pole));
          },
          [=](const V3f& w) {
            const V3f dir(transform_vector(V3d(w), from_pole));
            return hits(dir) ? light.pdf_solid_angle(at, dir, static_cast<float>(distance(dir))) : 0.0f;
          }),
      seed, 100000, 64);
}

AreaLight rectangle(const V3f& p0, const V3f& edge1, const V3f& edge2) {
  return {{p0, edge1, edge2, true}, V3f(2.0f), true, 0};
}

TEST(AreaLight, samples_match_their_density) {
  const V3f point(0.3f, -0.2f, 0.4f);
  const V3f tilted = V3f(0.5f, 1.0f, -0.3f).normalized();
  const std::vector<AreaLight> lights = {
      AreaLight(kCeiling),
      rectangle(V3f(-1, 2, -1), V3f(2, 0, 0), V3f(0, 0, 1.5f)),
      rectangle(V3f(-1, 0.5f, -1), V3f(2, 0, 0), V3f(0, 0, 3)),        // near
      rectangle(V3f(1, -0.5f, -1), V3f(0, 3, 0), V3f(0.5f, 0, 2)),     // across the horizon
      rectangle(V3f(-1, 2, -1), V3f(2, 0, 0), V3f(1.0f, 0.5f, 1.5f)),  // not right-angled: by area
      rectangle(V3f(-1, 3, -2), V3f(2, 0, 0), V3f(0, 0, 1.5f)),        // farther away than the diagonal
      rectangle(V3f(2, -0.5f, -1), V3f(0, 2, 0), V3f(1.5f, 0.5f, 0.3f))};
  std::uint32_t seed = 800;
  for (const AreaLight& light : lights) {
    for (const Receiver& at : {Receiver(point), Receiver(point, V3f(0, 1, 0)), Receiver(point, tilted)}) {
      const SamplerTest test = test_light(light, at, ++seed);
      EXPECT_GT(test.result.p_value, sidak_level(0.01, 21)) << at.normal << " " << test.replay;
      EXPECT_NEAR(test.integral, 1.0, 2e-3) << seed;
    }
  }
}

TEST(AreaLight, a_rectangle_reports_the_density_of_its_direction) {
  TestRandom random(820);
  for (const float height : {1e-4f, 0.01f, 0.3f, 2.0f, 20.0f, 1000.0f}) {
    const AreaLight light = rectangle(V3f(-0.5f, height, -0.75f), V3f(1, 0, 0), V3f(0, 0, 1.5f));
    for (int i = 0; i < 2000; ++i) {
      const V3f point(3.0f * random.next() - 1.5f, 0.0f, random.next());
      const Receiver at(point, V3f(random.next() - 0.5f, 1.0f, random.next() - 0.5f).normalized());
      const auto drawn = light.sample(at, random.next_2d());
      ASSERT_TRUE(drawn) << height << point;
      const float pdf = light.pdf_solid_angle(at, drawn->dir_world, drawn->distance);
      // Directions in float resolve a rectangle that is seen edge-on by less.
      ASSERT_NEAR(pdf / drawn->pdf_solid_angle, 1.0f, height < 0.1f ? 0.05f : 1e-3f) << height << point;
    }
  }
}

/// The solid angle, the irradiance and its estimate, from almost touching to far away.
TEST(AreaLight, irradiance_of_a_rectangle_at_any_distance) {
  const Receiver at(V3f(0.0f), V3f(0, 1, 0));
  for (const float height : {1e-3f, 0.05f, 0.4f, 3.0f, 15.0f, 100.0f}) {
    const AreaLight light = rectangle(V3f(-1, height, -1), V3f(2, 0, 0), V3f(0, 0, 2));
    // Four quarters, each with h / sqrt(1 + h^2) as both tangents.
    const double h = std::sqrt(1.0 + static_cast<double>(height) * height);
    const double exact = 2.0 * 4.0 * std::atan(1.0 / h) / h;
    const Estimate found = estimate(
        830, 20000, [&](TestRandom& r) { return irradiance(light.sample(at, r.next_2d()), at.normal); });
    EXPECT_NEAR(found.mean, exact, 4.0 * found.error + 1e-5 * exact) << height;
    EXPECT_NEAR(light.irradiance_at(at) / exact, 1.0, 2e-3) << height;
    // 4.2: atan of its form under the whole square.
    const Estimate fluence = estimate(831, 2000, [&](TestRandom& r) {
      return 1.0 / light.sample(at.position, r.next_2d())->pdf_solid_angle;
    });
    const double solid = 4.0 * std::asin(1.0 / (1.0 + static_cast<double>(height) * height));
    EXPECT_NEAR(fluence.mean / solid, 1.0, 1e-3 + 4.0 * fluence.error / solid) << height;
  }
}

/// Estimates of a lamp that is wholly above the horizon differ by little, whatever is drawn.
TEST(AreaLight, samples_follow_what_is_received) {
  const Receiver at(V3f(0.0f), V3f(0.3f, 1.0f, 0.2f).normalized());
  const auto expect_even = [&](const AreaLight& light) {
    constexpr int samples = 20000;
    const Estimate found = estimate(
        835, samples, [&](TestRandom& r) { return irradiance(light.sample(at, r.next_2d()), at.normal); });
    EXPECT_LT(found.error * std::sqrt(samples), 0.25 * found.mean) << light.p0 << light.edge2;
  };
  for (const float height : {0.5f, 2.0f, 3.0f, 6.0f, 50.0f})
    expect_even(rectangle(V3f(-0.7f, height, -0.8f), V3f(2, 0, 0), V3f(0, 0, 2)));
  for (const float height : {3.0f, 6.0f, 50.0f})
    expect_even(rectangle(V3f(-0.7f, height, -0.8f), V3f(2, 0, 0), V3f(0.5f, 0.3f, 1.5f)));
}

TEST(AreaLight, reaches_whom_it_sends_irradiance) {
  TestRandom random(836);
  int dark = 0;
  for (int i = 0; i < 5000; ++i) {
    const auto place = [&] { return V3f(random.next(), random.next(), random.next()) * 4.0f - V3f(2.0f); };
    const AreaLight light({place(), place(), place(), i % 2 == 0}, V3f(1.0f), i % 3 == 0, 0);
    const Receiver at(place(), i % 5 == 0 ? V3f(0.0f) : place().normalized());
    ASSERT_EQ(light.reaches(at), light.irradiance_at(at) > 0.0) << at.position << at.normal;
    dark += light.reaches(at) ? 0 : 1;
    if (!light.reaches(at)) continue;
    ASSERT_TRUE(light.sample(at, random.next_2d()));
  }
  EXPECT_GT(dark, 1000);
}

TEST(AreaLight, extremes_are_finite) {
  TestRandom random(840);
  for (const float scale : {1e-12f, 1e-3f, 1.0f, 1e6f, 1e12f}) {
    for (const V3f& unit : {V3f(0, 0, 0), V3f(0.3f, 1e-7f, 0.2f), V3f(0.3f, -1e-5f, 0.2f), V3f(5, 0, 0),
                            V3f(5, 1e-6f, 1), V3f(0.5f, -1e6f, 0.5f), V3f(1, -1, 1), V3f(0, -1e-3f, 0)}) {
      for (const bool quad : {false, true}) {
        const AreaLight light({V3f(0), V3f(scale, 0, 0), V3f(0, 0, scale), quad}, V3f(1e10f), true, 0);
        for (const V3f& normal : {V3f(0), V3f(0, 1, 0), V3f(0, -1, 0), V3f(1, 0, 0)}) {
          const Receiver at(unit * scale, normal);
          ASSERT_TRUE(std::isfinite(light.irradiance_at(at)) && light.irradiance_at(at) >= 0.0);
          for (int i = 0; i < 50; ++i) {
            const auto drawn = light.sample(at, random.next_2d());
            if (!drawn) continue;
            ASSERT_TRUE(drawn->pdf_solid_angle > 0.0f && std::isfinite(drawn->pdf_solid_angle))
                << scale << unit << normal;
            ASSERT_NEAR(drawn->dir_world.length(), 1.0f, 1e-5f) << scale << unit << normal;
            const float pdf = light.pdf_solid_angle(at, drawn->dir_world, drawn->distance);
            ASSERT_TRUE(pdf > 0.0f && std::isfinite(pdf)) << scale << unit << normal;
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace becalm::tracer
