// Triangle lights: samples against the density, its integral against the exact solid angle, and the extremes.
#include "tracer/lights/area_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

TEST(AreaLight, samples_are_uniform_by_area) {
  const AreaLight light(kCeiling);
  const V3f point(0.3f, -0.2f, 0.4f);
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
    ASSERT_GT(b1, -1e-5);
    ASSERT_GT(b2, -1e-5);
    ASSERT_LT(b1 + b2, 1.0 + 1e-5);
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
  for (const V3f& point : {V3f(0.3f, -0.2f, 0.4f), V3f(5, -3, 2), V3f(0, 1.9f, -0.5f)}) {
    // E[1 / pdf] over the samples is the solid angle.
    TestRandom random(5);
    double sum = 0.0;
    double squares = 0.0;
    constexpr int samples = 100000;
    for (int i = 0; i < samples; ++i) {
      const auto drawn = light.sample(point, random.next_2d());
      ASSERT_TRUE(drawn);
      ASSERT_EQ(drawn->pdf_solid_angle, light.pdf_solid_angle(drawn->dir_world, drawn->distance));
      const double value = 1.0 / drawn->pdf_solid_angle;
      sum += value;
      squares += value * value;
    }
    const double mean = sum / samples;
    const double error = std::sqrt((squares / samples - mean * mean) / samples);
    const V3d p(point);
    EXPECT_NEAR(mean, solid_angle(V3d(kCeiling.p0) - p, V3d(kCeiling.p1) - p, V3d(kCeiling.p2) - p),
                4 * error)
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
  EXPECT_DOUBLE_EQ(AreaLight(triangle).power(), 2.0 * AreaLight(kCeiling).power());
}

TEST(AreaLight, degenerate_triangles_give_nothing) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  for (const V3f& p2 : {V3f(2, 0, 0), V3f(0, 0, 0), V3f(nan, 0, 0), V3f(INFINITY, 1, 0)}) {
    const AreaLight light(EmissiveTriangle{V3f(0, 0, 0), V3f(1, 0, 0), p2, V3f(1), true});
    EXPECT_EQ(light.area, 0.0) << p2;
    EXPECT_EQ(light.power(), 0.0) << p2;
    EXPECT_EQ(light.pdf_solid_angle(V3f(0, 0, -1), 1.0f), 0.0f) << p2;
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
    EXPECT_TRUE(std::isfinite(AreaLight(triangle).power())) << scale;
  }
}

TEST(AreaLight, point_on_the_light_gives_nothing) {
  const AreaLight light(EmissiveTriangle{V3f(0, 0, 0), V3f(1, 0, 0), V3f(0, 1, 0), V3f(1), true});
  TestRandom random(1);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(light.sample(V3f(0.25f, 0.25f, 0.0f), random.next_2d()));
  EXPECT_FALSE(light.sample(V3f(0, 0, 0), V2f(1.0f, 1.0f)));
}

}  // namespace
}  // namespace becalm::tracer
