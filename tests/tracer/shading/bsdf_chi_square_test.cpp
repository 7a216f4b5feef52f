// Every BSDF's sampler against its density, over directions that graze, lean and face, on both sides.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <numbers>
#include <optional>
#include <string>

#include "tests/tracer/shading/bsdf_values.h"
#include "tests/tracer/shading/statistics.h"
#include "tests/tracer/shading/test_directions.h"
#include "tracer/materials/bsdf.h"

namespace becalm::tracer {
namespace {

constexpr double kThetas[] = {0.0, 30.0, 60.0, 85.0, 89.5, 135.0};
/// Keeps lobes away from the chart's seam at +-180 degrees.
constexpr double kPhi = 200.0;
constexpr double kRadians = std::numbers::pi / 180.0;
/// Of all tests in this file: (1 + 4 + 12) materials from each direction.
const double kLevel = sidak_level(0.01, 17 * 6);

void expect_sampler_matches(const Bsdf& bsdf, const std::string& name, std::uint32_t seed) {
  for (const double theta : kThetas) {
    const V3f wo = direction(theta, kPhi);
    const auto draw = [&](TestRandom& random) -> std::optional<V3f> {
      const V2f u = random.next_2d();
      const auto drawn = sample(bsdf, wo, u, random.next());
      return drawn ? std::optional(drawn->wi) : std::nullopt;
    };
    const auto pdf = [&](const V3f& wi) { return pdf_of(bsdf, wo, wi); };
    Chart chart = sphere_chart(draw, pdf);
    // Through the middle of what is mirrored or hardly turned, and around it, so that quadrature finds it
    // amid wide lobes.
    for (const double around : {-0.1, 0.0, 0.1}) {
      chart.jumps_x.push_back(kPhi * kRadians - std::numbers::pi + around);
      for (const double middle : {theta, 180.0 - theta}) chart.jumps_y.push_back(middle * kRadians + around);
    }
    const SamplerTest test = test_sampler(chart, ++seed, 40000, 128);
    EXPECT_GT(test.result.p_value, kLevel) << name << " wo theta " << theta << " " << test.replay;
    EXPECT_LT(test.integral, 1.001) << name << " wo theta " << theta;
  }
}

TEST(BsdfChiSquare, diffuse) {
  expect_sampler_matches(DiffuseBsdf{V3f(0.5f)}, "diffuse", 100);
}

TEST(BsdfChiSquare, conductor) {
  std::uint32_t seed = 200;
  for (const float alpha : {0.01f, 0.1f, 0.5f, 1.0f}) {
    expect_sampler_matches(ConductorBsdf{V3f(0.2f, 0.9f, 1.4f), V3f(3.9f, 2.4f, 1.6f), alpha},
                           fmt::format("conductor alpha {}", alpha), seed += 10);
  }
}

#ifdef __SANITIZE_ADDRESS__
/// The sanitizer looks at memory, which is the same for all; it makes quadrature four times as slow.
constexpr float kEtas[] = {1.5f};
#else
constexpr float kEtas[] = {1.5f, 1.0f / 1.5f, 1.05f, 2.5f};
#endif

void expect_dielectrics_match(float alpha, const V3f& transmittance, std::uint32_t seed) {
  for (const float eta : kEtas) {
    expect_sampler_matches(DielectricBsdf{eta, alpha, transmittance},
                           fmt::format("dielectric eta {:.3f} alpha {}", eta, alpha), seed += 10);
  }
}

TEST(BsdfChiSquare, dielectric_polished) {
  expect_dielectrics_match(0.05f, V3f(1.0f), 300);
}
TEST(BsdfChiSquare, dielectric_tinted) {
  expect_dielectrics_match(0.3f, V3f(0.2f, 0.5f, 0.1f), 400);
}
TEST(BsdfChiSquare, dielectric_rough) {
  expect_dielectrics_match(1.0f, V3f(1.0f), 500);
}

}  // namespace
}  // namespace becalm::tracer
