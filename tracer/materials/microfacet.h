#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tracer/math/vec.h"

namespace becalm::tracer {

// GGX microsurface in the shading frame, Smith's masking. w is a direction with w.z > 0, m a microfacet
// normal with m.z > 0. Everything is written by ggx_s so that grazing angles divide by nothing that vanishes.

/// Widths of the lobe along the tangent and the bitangent; one number is an isotropic lobe.
struct GgxAlpha {
  float x;
  float y;
  GgxAlpha(float alpha) : x(alpha), y(alpha) {}
  GgxAlpha(float alpha_x, float alpha_y) : x(alpha_x), y(alpha_y) {}
};

/// cos (1 + 2 Lambda(w)) = sqrt(cos^2 + alpha^2 sin^2), with the alpha of w's azimuth: positive for alpha >
/// 0, tends to alpha at grazing angles.
inline float ggx_s(const V3f& w, const GgxAlpha& alpha) {
  return std::sqrt(w.z * w.z + alpha.x * alpha.x * w.x * w.x + alpha.y * alpha.y * w.y * w.y);
}

/// Distribution of normals, D(m); the integral of D(m) m.z over the hemisphere is 1.
inline float ggx_d(const V3f& m, const GgxAlpha& alpha) {
  const float t = m.x * m.x / (alpha.x * alpha.x) + m.y * m.y / (alpha.y * alpha.y) + m.z * m.z;
  return 1.0f / (std::numbers::pi_v<float> * alpha.x * alpha.y * t * t);
}

/// Smith's G1(w) / cos(w).
inline float ggx_g1_over_cos(const V3f& w, const GgxAlpha& alpha) {
  return 2.0f / (w.z + ggx_s(w, alpha));
}

/// Density per solid angle of the visible normals D(m) G1(w) max(0, w.m) / cos(w) (Heitz, "Understanding the
/// Masking-Shadowing Function", 2014, eq. 16).
inline float ggx_pdf_visible_normal(const V3f& w, const V3f& m, const GgxAlpha& alpha) {
  return ggx_d(m, alpha) * ggx_g1_over_cos(w, alpha) * std::max(0.0f, w.dot(m));
}

/// A microfacet normal with that density. The distribution is that of Heitz, "Sampling the GGX Distribution
/// of Visible Normals", JCGT 7(4), 2018; drawn as the half vector of a uniform spherical cap (Dupuy and
/// Benyoub, "Sampling Visible GGX Normals with Spherical Caps", 2023), which needs no frame and stays stable
/// at grazing angles.
inline V3f ggx_sample_visible_normal(const V3f& w, const GgxAlpha& alpha, const V2f& u) {
  const float sx = alpha.x * w.x;
  const float sy = alpha.y * w.y;
  const float inv_length = 1.0f / std::sqrt(sx * sx + sy * sy + w.z * w.z);
  const V3f stretched(sx * inv_length, sy * inv_length, w.z * inv_length);

  // The cap is z in [-stretched.z, 1]. With t = z + stretched.z, 1 - z^2 is a product without cancellation.
  const float phi = 2.0f * std::numbers::pi_v<float> * u.x;
  const float height = 1.0f + stretched.z;
  const float t = (1.0f - u.y) * height;
  const float one_minus_wz = (stretched.x * stretched.x + stretched.y * stretched.y) / height;
  const float radius = std::sqrt(u.y * height * (t + one_minus_wz));
  const V3f m(alpha.x * (radius * std::cos(phi) + stretched.x),
              alpha.y * (radius * std::sin(phi) + stretched.y), t);
  const float length = m.length();
  return length > 0.0f ? m / length : V3f(0.0f, 0.0f, 1.0f);
}

/// Density of wi when the visible normal halfway between wo and wi is drawn: divided by 4 wo.m, which
/// cancels.
inline float pdf_mirrored_normal(const V3f& wo, const V3f& m, const GgxAlpha& alpha) {
  return 0.25f * ggx_d(m, alpha) * ggx_g1_over_cos(wo, alpha);
}

/// G2 D / (4 cos_o) of the height-correlated Smith model, without Fresnel: what a microsurface of perfect
/// mirrors reflects, including |cos wi|. wo.z, wi.z > 0.
inline float mirrored(const V3f& wo, const V3f& wi, const V3f& m, const GgxAlpha& alpha) {
  return ggx_d(m, alpha) * 0.5f * wi.z / (wo.z * ggx_s(wi, alpha) + wi.z * ggx_s(wo, alpha));
}

/// mirrored() / pdf_mirrored_normal(): G2 / G1, at most 1.
inline float mirrored_weight(const V3f& wo, const V3f& wi, const GgxAlpha& alpha) {
  const float s_o = ggx_s(wo, alpha);
  return wi.z * (wo.z + s_o) / (wo.z * ggx_s(wi, alpha) + wi.z * s_o);
}

}  // namespace becalm::tracer
