#pragma once

#include <algorithm>
#include <cmath>

namespace becalm::tracer {

/// Share of unpolarised light that a clear interface reflects, in [0,1]. `cos_o` in [0,1] is on the side of
/// wo, `eta_ratio` the index of refraction on the other side over that on this one. 1 where reflection is
/// total. When `cos_t` is given, it receives the cosine on the other side, 0 where reflection is total.
inline float fresnel_dielectric(float cos_o, float eta_ratio, float* cos_t = nullptr) {
  // cos^2 across, 1 - sin^2 / eta_ratio^2, arranged so that grazing angles and ratios near 1 keep their
  // digits.
  const float cos2 = ((eta_ratio - 1.0f) * (eta_ratio + 1.0f) + cos_o * cos_o) / (eta_ratio * eta_ratio);
  if (cos_t != nullptr) *cos_t = std::sqrt(std::max(0.0f, cos2));
  if (cos2 <= 0.0f) return 1.0f;
  const float cos_across = std::sqrt(cos2);
  const float parallel = (eta_ratio * cos_o - cos_across) / (eta_ratio * cos_o + cos_across);
  const float perpendicular = (cos_o - eta_ratio * cos_across) / (cos_o + eta_ratio * cos_across);
  return std::min(1.0f, 0.5f * (parallel * parallel + perpendicular * perpendicular));
}

/// Larger indices are clamped to this: such a metal reflects 99.96% at normal incidence.
inline constexpr double kLargestIndex = 1e4;

/// Share of unpolarised light that a metal with index of refraction eta + i k reflects in air, in [0,1];
/// exact. `cos_o` in [0,1]; eta and k >= 0, at most kLargestIndex. Source: Born and Wolf, section 14.2, by
/// real arithmetic: (a + i b)^2 = (eta + i k)^2 - sin^2.
inline float fresnel_conductor(float cos_o, float eta, float k) {
  const double c = cos_o;
  const double cos2 = c * c;
  const double sin2 = std::max(0.0, 1.0 - cos2);
  const double n = std::min<double>(eta, kLargestIndex);
  const double kk = std::min<double>(k, kLargestIndex);
  const double real = (n - 1.0) * (n + 1.0) - kk * kk + cos2;
  const double modulus = std::sqrt(real * real + 4.0 * n * n * kk * kk);
  // The larger of a and b first, the other from a b = eta k: neither suffers from cancellation.
  double a = std::sqrt(0.5 * (modulus + std::abs(real)));
  if (real < 0.0) a = a > 0.0 ? n * kk / a : 0.0;

  const double s_den = modulus + cos2 + 2.0 * a * c;
  if (s_den <= 0.0) return 1.0f;  // grazing, and no contrast: the limit depends on the path
  const double perpendicular = (modulus + cos2 - 2.0 * a * c) / s_den;
  const double p_den = cos2 * modulus + sin2 * sin2 + 2.0 * a * c * sin2;
  if (p_den <= 0.0) return static_cast<float>(perpendicular);
  const double parallel = perpendicular * (cos2 * modulus + sin2 * sin2 - 2.0 * a * c * sin2) / p_den;
  return static_cast<float>(std::clamp(0.5 * (perpendicular + parallel), 0.0, 1.0));
}

}  // namespace becalm::tracer
