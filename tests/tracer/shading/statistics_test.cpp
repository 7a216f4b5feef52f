// The statistical tools themselves: published quantiles, and that the sampler test does fail on a wrong
// density.
#include "tests/tracer/shading/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace becalm::tracer {
namespace {

TEST(Statistics, chi_square_quantiles) {
  EXPECT_NEAR(chi_square_p_value(3.841, 1), 0.05, 1e-4);
  EXPECT_NEAR(chi_square_p_value(23.209, 10), 0.01, 1e-5);
  EXPECT_NEAR(chi_square_p_value(149.449, 100), 0.001, 1e-6);
  EXPECT_NEAR(chi_square_p_value(99.334, 100), 0.5, 1e-4);
  EXPECT_NEAR(chi_square_p_value(2.0 * 20.0, 2), std::exp(-20.0), 1e-15);
}

TEST(Statistics, sidak_level_of_many_tests) {
  EXPECT_NEAR(1.0 - std::pow(1.0 - sidak_level(0.01, 80), 80), 0.01, 1e-12);
}

TEST(Statistics, integrates_a_narrow_peak) {
  const auto peak = [](const V2d& p) { return std::exp(-((p.x - 0.3) * (p.x - 0.3) + p.y * p.y) / (2e-4)); };
  EXPECT_NEAR(integrate(peak, {-1, 1, -1, 1}) / (2e-4 * std::numbers::pi), 1.0, 1e-3);
}

/// Uniform hemisphere, with a density that claims `pdf_scale` times too much and leaves out `lost` of the
/// samples.
Chart hemisphere(float pdf_scale, float lost) {
  return sphere_chart(
      [lost](TestRandom& random) -> std::optional<V3f> {
        const V2f u = random.next_2d();
        const float radius = std::sqrt(1.0f - u.y * u.y);
        const float phi = 2.0f * std::numbers::pi_v<float> * u.x;
        if (random.next() < lost) return std::nullopt;
        return V3f(radius * std::cos(phi), radius * std::sin(phi), u.y);
      },
      [pdf_scale](const V3f& w) {
        return w.z > 0.0f ? pdf_scale * 0.5f * std::numbers::inv_pi_v<float> : 0.0f;
      });
}

TEST(Statistics, sampler_test_accepts_the_right_density) {
  const SamplerTest whole = test_sampler(hemisphere(1.0f, 0.0f), 1);
  EXPECT_GT(whole.result.p_value, 1e-3) << whole.replay;
  EXPECT_NEAR(whole.integral, 1.0, 1e-4);
  const SamplerTest part = test_sampler(hemisphere(0.9f, 0.1f), 2);
  EXPECT_GT(part.result.p_value, 1e-3) << part.replay;
}

TEST(Statistics, sampler_test_rejects_wrong_densities) {
  EXPECT_LT(test_sampler(hemisphere(0.98f, 0.0f), 1).result.p_value, 1e-9);
  EXPECT_NEAR(test_sampler(hemisphere(1.02f, 0.0f), 1).integral, 1.02, 1e-4);
  EXPECT_LT(test_sampler(hemisphere(1.0f, 0.02f), 1).result.p_value, 1e-9);
  Chart cosine = hemisphere(1.0f, 0.0f);
  cosine.density = [](const V2d& p) {
    return p.y < 0.5 * std::numbers::pi ? std::cos(p.y) * std::sin(p.y) / std::numbers::pi : 0.0;
  };
  EXPECT_LT(test_sampler(cosine, 1).result.p_value, 1e-9);
}

}  // namespace
}  // namespace becalm::tracer
