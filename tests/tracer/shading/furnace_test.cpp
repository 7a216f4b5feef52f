// White furnace: what a white material returns of uniform light from everywhere.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "tests/tracer/shading/bsdf_values.h"
#include "tests/tracer/shading/statistics.h"
#include "tests/tracer/shading/test_directions.h"
#include "tracer/materials/bsdf.h"
#include "tracer/sampling/sampler.h"

namespace becalm::tracer {
namespace {

const V3f kAllReflectingEta(0.0f);
const V3f kAllReflectingK(1.0f);

/// Energy that leaves for energy that comes, by the sampler: the compression of radiance taken out.
struct Energy {
  double mean = 0.0;
  double standard_error = 0.0;
  double largest_sample = 0.0;
};

Energy energy(const Bsdf& bsdf, const V3f& wo, int samples = 4096) {
  double sum = 0.0;
  double squares = 0.0;
  Energy result;
  for (int i = 0; i < samples; ++i) {
    Sampler sampler(1, 0, 0, 0, static_cast<std::uint32_t>(i));
    const V2f u = sampler.next_2d();
    const auto drawn = sample(bsdf, wo, u, sampler.next_1d());
    const double value = drawn ? static_cast<double>(drawn->weight.x) / drawn->radiance_scale : 0.0;
    sum += value;
    squares += value * value;
    result.largest_sample = std::max(result.largest_sample, value);
  }
  result.mean = sum / samples;
  // An upper bound: the samples are stratified.
  result.standard_error = std::sqrt(std::max(0.0, squares / samples - result.mean * result.mean) / samples);
  return result;
}

/// The same by quadrature of value_of() over the sphere.
double energy_by_quadrature(const Bsdf& bsdf, const V3f& wo) {
  const float n = std::holds_alternative<DielectricBsdf>(bsdf) ? std::get<DielectricBsdf>(bsdf).eta : 1.0f;
  const float ratio = wo.z > 0.0f ? n : 1.0f / n;
  const Chart chart = sphere_chart([](TestRandom&) -> std::optional<V3f> { return std::nullopt; },
                                   [&](const V3f& wi) {
                                     const float compression = wo.z * wi.z < 0.0f ? ratio * ratio : 1.0f;
                                     return value_of(bsdf, wo, wi).x * compression;
                                   });
  Cell upper = chart.domain;
  Cell lower = chart.domain;
  upper.y1 = lower.y0 = 0.5 * chart.domain.y1;
  return integrate(chart.density, upper) + integrate(chart.density, lower);
}

TEST(WhiteFurnace, smooth_materials_lose_nothing) {
  for (const float theta : {0.0f, 30.0f, 70.0f, 89.9f, 110.0f, 179.0f}) {
    const V3f wo = direction(theta, 10.0);
    const Energy mirror = energy(ConductorBsdf{kAllReflectingEta, kAllReflectingK, 0.0f}, wo, 64);
    EXPECT_EQ(mirror.mean, 1.0);
    for (const float eta : {0.5f, 1.0f, 1.0001f, 1.5f, 3.0f}) {
      const Energy glass = energy(DielectricBsdf{eta, 0.0f, V3f(1.0f)}, wo, 64);
      EXPECT_NEAR(glass.mean, 1.0, 1e-6) << "eta " << eta << " theta " << theta;
      EXPECT_NEAR(glass.largest_sample, 1.0, 1e-6) << "eta " << eta << " theta " << theta;
    }
    const Energy diffuse = energy(DiffuseBsdf{V3f(1.0f)}, wo, 64);
    EXPECT_EQ(diffuse.mean, 1.0);
  }
}

/// A metal that absorbs nothing, rough: what meets further microfacets comes back as well. Smooth metals lose
/// light at grazing angles, where little of it is given back (multiple_scattering.h).
TEST(WhiteFurnace, rough_conductor_loses_nothing) {
  struct Bound {
    float alpha;
    double largest_loss;
  };
  for (const auto& [alpha, largest_loss] :
       {Bound{0.01f, 0.1}, Bound{0.1f, 0.01}, Bound{0.25f, 0.004}, Bound{0.5f, 0.004}, Bound{1.0f, 0.004}}) {
    for (const float theta : {0.0f, 45.0f, 75.0f, 85.0f, 89.0f}) {
      const Bsdf metal = ConductorBsdf{kAllReflectingEta, kAllReflectingK, alpha};
      const Energy sampled = energy(metal, direction(theta, 0.0));
      const std::string replay =
          fmt::format("alpha {} theta {}: loss {:.4f}", alpha, theta, 1 - sampled.mean);
      EXPECT_LT(sampled.mean, 1.0 + 2e-3 + 5.0 * sampled.standard_error) << replay;
      EXPECT_GT(sampled.mean, 1.0 - largest_loss - 5.0 * sampled.standard_error) << replay;
      EXPECT_LT(sampled.largest_sample, alpha < 0.1f ? 10.0 : 3.0) << replay;
      if (alpha < 0.1f) continue;  // quadrature over the whole sphere resolves no narrower lobe
      EXPECT_NEAR(energy_by_quadrature(metal, direction(theta, 0.0)), sampled.mean,
                  5.0 * sampled.standard_error + 2e-3)
          << replay;
    }
  }
}

/// Clear interfaces from both sides. What remains lost: the margin of the tables, and at grazing angles of
/// polished ones what multiple_scattering.h does not give back.
TEST(WhiteFurnace, rough_dielectric_loses_nothing) {
  for (const float alpha : {0.01f, 0.1f, 0.25f, 0.5f, 1.0f}) {
    for (const float eta : {1.1f, 1.33f, 1.5f, 1.8f, 2.4f}) {
      for (const float theta :
           {0.0f, 45.0f, 60.0f, 75.0f, 85.0f, 95.0f, 115.0f, 130.0f, 135.0f, 150.0f, 180.0f}) {
        const Bsdf glass = DielectricBsdf{eta, alpha, V3f(1.0f)};
        const Energy sampled = energy(glass, direction(theta, 0.0));
        const std::string replay =
            fmt::format("alpha {} eta {} theta {}: loss {:.4f}", alpha, eta, theta, 1 - sampled.mean);
        EXPECT_LT(sampled.mean, 1.0 + 2e-3 + 5.0 * sampled.standard_error) << replay;
        EXPECT_GT(sampled.mean, 1.0 - 0.01 - 5.0 * sampled.standard_error) << replay;
        EXPECT_LT(sampled.largest_sample, 10.0) << replay;
        if (alpha < 0.25f) continue;
        EXPECT_NEAR(energy_by_quadrature(glass, direction(theta, 0.0)), sampled.mean,
                    5.0 * sampled.standard_error + 4e-3)
            << replay;
      }
    }
  }
}

}  // namespace
}  // namespace becalm::tracer
