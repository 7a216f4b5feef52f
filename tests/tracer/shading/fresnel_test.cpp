// Fresnel's equations against their complex form in double precision, and against known values.
#include "tracer/materials/fresnel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "tracer/materials/conductor_ior.h"
#include "tracer/materials/interface_albedo.h"

namespace becalm::tracer {
namespace {

double reference(double cos_o, std::complex<double> index) {
  const std::complex<double> cos_t = std::sqrt(1.0 - (1.0 - cos_o * cos_o) / (index * index));
  const double s = std::norm((cos_o - index * cos_t) / (cos_o + index * cos_t));
  const double p = std::norm((index * cos_o - cos_t) / (index * cos_o + cos_t));
  return 0.5 * (s + p);
}

TEST(Fresnel, conductor_agrees_with_complex_arithmetic) {
  for (const float cos_o : {1e-4f, 0.01f, 0.1f, 0.3f, 0.5f, 0.7071f, 0.9f, 0.999f, 1.0f}) {
    for (const float eta : {0.05f, 0.2f, 0.9f, 1.0f, 1.5f, 4.0f, 100.0f}) {
      for (const float k : {0.001f, 0.1f, 1.0f, 3.9f, 50.0f, 3000.0f}) {
        EXPECT_NEAR(fresnel_conductor(cos_o, eta, k), reference(cos_o, {eta, k}), 1e-6)
            << "cos " << cos_o << " eta " << eta << " k " << k;
      }
    }
  }
}

TEST(Fresnel, conductor_without_absorption_is_a_dielectric) {
  for (const float cos_o : {0.001f, 0.2f, 0.6f, 1.0f}) {
    for (const float eta : {0.5f, 1.0f, 1.0001f, 1.5f, 3.0f}) {
      EXPECT_NEAR(fresnel_conductor(cos_o, eta, 0.0f), fresnel_dielectric(cos_o, eta), 2e-6)
          << "cos " << cos_o << " eta " << eta;
    }
  }
}

TEST(Fresnel, limits) {
  EXPECT_FLOAT_EQ(fresnel_dielectric(1.0f, 1.5f), 0.04f);
  EXPECT_FLOAT_EQ(fresnel_dielectric(1.0f, 1.0f / 1.5f), 0.04f);
  EXPECT_EQ(fresnel_dielectric(0.0f, 1.5f), 1.0f);
  EXPECT_EQ(fresnel_dielectric(0.5f, 1.0f / 1.5f), 1.0f);  // total: 60 degrees
  EXPECT_EQ(fresnel_dielectric(0.7f, 1.0f), 0.0f);
  // Brewster's angle: only the perpendicular half reflects.
  const double brewster = std::cos(std::atan(1.5));
  const double perpendicular = (1.0 - 1.5 * 1.5) / (1.0 + 1.5 * 1.5);
  EXPECT_NEAR(fresnel_dielectric(static_cast<float>(brewster), 1.5f), 0.5 * perpendicular * perpendicular,
              1e-6);
  for (const float cos_o : {1e-30f, 0.1f, 1.0f}) EXPECT_EQ(fresnel_conductor(cos_o, 0.0f, 1.0f), 1.0f);
  EXPECT_NEAR(fresnel_conductor(0.7f, 1.0f, 0.0f), 0.0f, 1e-7f);
  EXPECT_NEAR(fresnel_conductor(1e-8f, 0.2f, 3.9f), 1.0f, 1e-6f);
}

TEST(Fresnel, reports_the_cosine_across) {
  float cos_t = -1.0f;
  fresnel_dielectric(0.8f, 1.5f, &cos_t);
  EXPECT_NEAR(cos_t, std::sqrt(1.0 - 0.36 / 2.25), 1e-6);
  fresnel_dielectric(0.5f, 1.0f / 1.5f, &cos_t);
  EXPECT_EQ(cos_t, 0.0f);
}

TEST(ConductorIor, reflects_the_wanted_colour_at_normal_incidence) {
  for (const float r : {0.0f, 1e-6f, 0.04f, 0.5f, 0.9f, 0.999f, 1.0f, 2.0f}) {
    const float wanted = std::min(r, 1.0f);
    const ConductorIor plain = conductor_from_reflectance(V3f(r));
    EXPECT_NEAR(fresnel_conductor(1.0f, plain.eta.x, plain.k.x), wanted, 1e-5f);
  }
}

TEST(Fresnel, mean_transmittance_is_that_of_uniform_light) {
  for (const float n : {1e-3f, 0.3f, 0.667f, 0.99f, 1.0f, 1.0001f, 1.01f, 1.33f, 1.5f, 2.4f, 10.0f, 1e3f}) {
    double sum = 0.0;
    constexpr int steps = 20000;
    for (int i = 0; i < steps; ++i) {
      // Uniform in the squared cosine.
      const double cosine = std::sqrt((i + 0.5) / steps);
      sum += 1.0 - fresnel_dielectric(static_cast<float>(cosine), n);
    }
    EXPECT_NEAR(mean_fresnel_transmittance(n), sum / steps, 2e-4) << n;
    const float back = mean_fresnel_transmittance(1.0f / n);
    EXPECT_NEAR(mean_fresnel_transmittance(n), n * n * back, 1e-5f * n * n * back)
        << "radiance over n^2 is kept";
  }
}

}  // namespace
}  // namespace becalm::tracer
