#include "tracer/media/phase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/tracer/media/test_media.h"
#include "tests/tracer/shading/test_directions.h"

namespace becalm::tracer {
namespace {

constexpr float kMeanCosines[] = {-0.9f, 0.0f, 0.3f, 0.97f};

TEST(Phase, SamplerMatchesItsDensity) {
  const double level = sidak_level(0.01, 4 * 3);
  std::uint32_t seed = 10;
  for (const float g : kMeanCosines) {
    for (const double theta : {0.0, 70.0, 180.0}) {
      const V3f wo = direction(theta, 200.0);
      const SamplerTest test =
          test_sampler(sphere_chart(
                           [&](TestRandom& random) -> std::optional<V3f> {
                             return sample_henyey_greenstein(g, wo, random.next_2d()).wi;
                           },
                           [&](const V3f& wi) { return phase_henyey_greenstein(g, wo, wi); }),
                       ++seed, 40000, 128);
      EXPECT_GT(test.result.p_value, level) << "g " << g << " theta " << theta << " " << test.replay;
      EXPECT_NEAR(test.integral, 1.0, 1e-3) << "g " << g;
    }
  }
}

TEST(Phase, ValueIsThatOfTheFormula) {
  const V3f wo = direction(30.0, 10.0);
  for (const double g : {-0.95, -0.5, 0.0, 0.25, 0.9}) {
    for (const double theta : {0.0, 20.0, 90.0, 150.0, 180.0}) {
      const V3f wi = direction(theta, 140.0);
      const double cos = -V3d(wo).dot(V3d(wi));
      const double expected =
          (1.0 - g * g) / (4.0 * std::numbers::pi * std::pow(1.0 + g * g - 2.0 * g * cos, 1.5));
      EXPECT_NEAR(phase_henyey_greenstein(static_cast<float>(g), wo, wi), expected, 1e-5 * expected)
          << "g " << g << " theta " << theta;
    }
  }
}

TEST(Phase, MeanCosineIsGAndPositiveIsForward) {
  const double level = sidak_level(0.01, 6);
  TestRandom random(7);
  const V3f wo = direction(120.0, 33.0);
  for (const float g : {-0.9f, -0.2f, 0.0f, 0.3f, 0.97f, 0.999f}) {
    MeanTest cosine;
    for (int i = 0; i < 100000; ++i) {
      cosine.add(-wo.dot(sample_henyey_greenstein(g, wo, random.next_2d()).wi));
    }
    EXPECT_GT(cosine.p_value(g), level) << "g " << g << " mean " << cosine.mean() << " seed 7";
  }
}

TEST(Phase, NarrowLobesStaySound) {
  TestRandom random(8);
  for (const float g : {-0.999f, -1e-7f, 0.0f, 1e-30f, 0.999f}) {
    for (int i = 0; i < 20000; ++i) {
      V2f u = random.next_2d();
      if (i % 3 == 1) u.x = 0.0f;
      if (i % 3 == 2) u.x = 1.0f - 0x1p-24f;
      const V3f wo = direction(180.0 * random.next(), 360.0 * random.next());
      const PhaseSample sample = sample_henyey_greenstein(g, wo, u);
      ASSERT_NEAR(sample.wi.length(), 1.0f, 1e-6f);
      const float value = phase_henyey_greenstein(g, wo, sample.wi);
      // Directions of 32 bits know the angle to 1e-7, the narrowest lobe is 1e-3 wide.
      ASSERT_NEAR(sample.pdf_solid_angle, value, 2e-3f * value) << "g " << g << " u " << u.x << " " << u.y;
      ASSERT_GT(value, 0.0f);
    }
  }
}

}  // namespace
}  // namespace becalm::tracer
