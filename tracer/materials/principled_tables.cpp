#include "tracer/materials/principled_tables.h"

#include <numbers>

#include "tracer/materials/local_direction.h"
#include "tracer/materials/microfacet.h"

namespace becalm::tracer {

namespace {

constexpr int kSteps = 48;  ///< of each number that draws a direction

float fifth_power(float v) {
  const float v2 = v * v;
  return v2 * v2 * v;
}

V3f direction_at(float cosine) {
  return {std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)), 0.0f, cosine};
}

GgxAlbedo integrate_ggx(float cosine, float alpha) {
  if (alpha == 0.0f) {
    const float schlick = fifth_power(1.0f - cosine);
    return {1.0f - schlick, schlick};
  }
  // The limit at the horizon is approached, not reached.
  const V3f wo = direction_at(std::max(cosine, 1e-5f));
  double f0 = 0.0, f90 = 0.0;
  for (int j = 0; j < kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i) {
      // Both halves of the azimuth are alike.
      const V2f u(0.5f * (static_cast<float>(i) + 0.5f) / kSteps, (static_cast<float>(j) + 0.5f) / kSteps);
      const V3f m = ggx_sample_visible_normal(wo, alpha, u);
      const V3f wi = reflect(wo, m);
      if (wi.z <= 0.0f) continue;
      const double weight = mirrored_weight(wo, wi, alpha);
      const double schlick = fifth_power(1.0f - std::clamp(wo.dot(m), 0.0f, 1.0f));
      f0 += weight * (1.0 - schlick);
      f90 += weight * schlick;
    }
  }
  constexpr double count = kSteps * kSteps;
  return {static_cast<float>(f0 / count), static_cast<float>(f90 / count)};
}

float integrate_sheen(float cosine) {
  const V3f wo = direction_at(cosine);
  double sum = 0.0;
  for (int j = 0; j < kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i) {
      const float radius2 = (static_cast<float>(j) + 0.5f) / kSteps;
      const float phi = std::numbers::pi_v<float> * (static_cast<float>(i) + 0.5f) / kSteps;
      const V3f wi(std::sqrt(radius2) * std::cos(phi), std::sqrt(radius2) * std::sin(phi),
                   std::sqrt(1.0f - radius2));
      sum += fifth_power(1.0f - std::clamp(wo.dot((wo + wi).normalized()), 0.0f, 1.0f));
    }
  }
  return static_cast<float>(std::numbers::pi * sum / (kSteps * kSteps));
}

}  // namespace

const PrincipledTables& PrincipledTables::get() {
  static const PrincipledTables tables;
  return tables;
}

PrincipledTables::PrincipledTables() {
  const auto axis = [](int i) {
    const float root = static_cast<float>(i) / (kSize - 1);
    return root * root;
  };
  for (int i = 0; i < kSize; ++i) {
    sheen_[i] = integrate_sheen(axis(i));
    for (int j = 0; j < kSize; ++j) ggx_[i][j] = integrate_ggx(axis(j), axis(i));

    // 2 int E(cos) cos dcos = 4 int E(x^2) x^3 dx, x the root of the cosine, and E linear between the nodes:
    // in each interval a polynomial of degree 4, for which three points of Gauss are exact.
    constexpr double step = 1.0 / (kSize - 1);
    double f0 = 0.0, f90 = 0.0;
    for (int j = 0; j + 1 < kSize; ++j) {
      for (const int k : {-1, 0, 1}) {
        const double t = 0.5 + 0.5 * k * 0.7745966692414834;
        const double weight = k == 0 ? 4.0 / 9.0 : 5.0 / 18.0;
        const double x = (j + t) * step;
        const GgxAlbedo at = mix(ggx_[i][j], ggx_[i][j + 1], static_cast<float>(t));
        f0 += 4.0 * weight * step * x * x * x * at.f0;
        f90 += 4.0 * weight * step * x * x * x * at.f90;
      }
    }
    ggx_mean_[i] = {static_cast<float>(f0), static_cast<float>(f90)};
  }
}

}  // namespace becalm::tracer
