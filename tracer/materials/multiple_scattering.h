#pragma once

#include <algorithm>

namespace becalm::tracer {

// Light that leaves a microsurface after two and more bounces, as a lobe (1 - E(wo)) (1 - E(wi)) gain / pi of
// the albedo E of one scattering without absorption (Kulla and Conty, "Revisiting Physically Based Shading at
// Imageworks", 2017).

/// Mean share of light that one scattering loses, as the lobe's gain divides by it. Smooth surfaces lose
/// light at grazing angles alone. The cosine lobe that gives it back is rarely sampled there, with large
/// weights; so less is given back where little is lost on average.
inline float multiple_scattering_loss(float mean_albedo) {
  constexpr float least_lost = 0.01f;
  return std::max(1.0f - mean_albedo, least_lost);
}

/// The colour of that light for conductors that reflect f0 facing and f90 at grazing angles, where one that
/// absorbs nothing would send out all: F^2 E / (1 - F (1 - E)) with the mean albedo E and the mean Fresnel
/// reflectance F, of Schlick's.
inline float multiple_scattering_color(float f0, float f90, float mean_albedo) {
  const float fresnel = f0 + (f90 - f0) / 21.0f;  // 2 int F(cos) cos dcos
  return fresnel * fresnel * mean_albedo / (1.0f - fresnel * (1.0f - mean_albedo));
}

/// The lobe's gain over its colour.
inline float multiple_scattering_gain(float mean_albedo) {
  return 1.0f / multiple_scattering_loss(mean_albedo);
}

}  // namespace becalm::tracer
