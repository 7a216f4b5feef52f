#pragma once

#include <algorithm>

#include "tracer/materials/bsdf.h"
#include "tracer/materials/principled_tables.h"

namespace becalm::tracer {

// Albedos of the principled model's layers; the model is in principled.inl.

/// Reflectance at grazing angles of what reflects f0 at normal incidence: 1, but less where hardly anything
/// is there to reflect (below 2%, an index of 1.33).
inline float f90_of(float f0) {
  return std::min(1.0f, 50.0f * f0);
}

/// Reflectance of the clear coat at normal incidence, of index 1.5.
inline constexpr float kCoatF0 = 0.04f;

/// The base's lobe. Delta lobes lose nothing.
inline GgxShape specular_shape(const PrincipledBsdf& bsdf) {
  return bsdf.alpha < kSmoothAlpha ? GgxShape{0.0f, 1.0f} : GgxShape{bsdf.alpha, bsdf.aspect};
}

/// What the layers reflect of uniform light, seen at one cosine.
struct PrincipledAlbedo {
  GgxAlbedo specular;  ///< of metal and dielectric, scattered once
  float dielectric;    ///< of the dielectric's surface, scattered any number of times
  float sheen;         ///< in its strongest channel
  float coat;

  /// Share of light that one scattering loses on a microsurface that absorbs nothing. Rounding errors count
  /// as 0.
  float lost() const {
    const float lost = 1.0f - specular.f0 - specular.f90;
    return lost > 1e-6f ? lost : 0.0f;
  }
};

inline PrincipledAlbedo principled_albedo(const PrincipledBsdf& bsdf, float cosine) {
  const PrincipledTables& tables = PrincipledTables::get();
  PrincipledAlbedo at;
  at.specular = tables.albedo(cosine, specular_shape(bsdf));
  at.dielectric = bsdf.f0 * at.specular.f0 + f90_of(bsdf.f0) * at.specular.f90 + bsdf.multiple_f0 * at.lost();
  const float sheen = std::max({bsdf.sheen.x, bsdf.sheen.y, bsdf.sheen.z});
  at.sheen = sheen > 0.0f ? sheen * tables.sheen_albedo(cosine) : 0.0f;
  at.coat = 0.0f;
  if (bsdf.coat > 0.0f) {
    const GgxAlbedo coat = tables.albedo(cosine, {bsdf.coat_alpha, 1.0f});
    at.coat = bsdf.coat * (kCoatF0 * coat.f0 + coat.f90);
  }
  return at;
}

}  // namespace becalm::tracer
