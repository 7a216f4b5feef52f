#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "tracer/materials/albedo_table.h"

namespace becalm::tracer {

/// What a GGX microsurface under Schlick's Fresnel reflects of uniform light after one scattering:
/// f0 F0 + f90 F90.
struct GgxAlbedo {
  float f0;
  float f90;
};

/// Widths of a GGX lobe by their geometric mean and the root of their ratio: alpha_x = mean / aspect along
/// the tangent, alpha_y = mean * aspect across.
struct GgxShape {
  float alpha;   ///< [0,1]
  float aspect;  ///< [kLeastAspect, 1]
};

/// Of full anisotropy: a lobe ten times as long as wide.
inline constexpr float kLeastAspect = 0.316227766f;

/// Albedos of the principled model's lobes; integrated when first asked for, those of anisotropic lobes
/// apart. Axes are alpha, the cosine and the aspect. Of an anisotropic lobe the table has the largest albedo
/// over all azimuths, so that what is given back for what is lost never exceeds it.
class PrincipledTables {
 public:
  static const PrincipledTables& get();

  /// At a cosine in [0,1].
  GgxAlbedo albedo(float cosine, const GgxShape& shape) const {
    return at_shape(shape, [&](const Slice& slice, const TablePosition& row) {
      const TablePosition column = table_position(std::sqrt(cosine), kCosines);
      const auto &low = slice.albedo[row.index], &high = slice.albedo[row.index + 1];
      return mix(mix(low[column.index], low[column.index + 1], column.fraction),
                 mix(high[column.index], high[column.index + 1], column.fraction), row.fraction);
    });
  }
  /// Its mean over the hemisphere, weighed by the cosine.
  GgxAlbedo mean_albedo(const GgxShape& shape) const {
    return at_shape(shape, [&](const Slice& slice, const TablePosition& row) {
      return mix(slice.mean[row.index], slice.mean[row.index + 1], row.fraction);
    });
  }
  /// Of a sheen (1 - cos(difference))^5, which is its value and not divided by pi; below 0.1.
  float sheen_albedo(float cosine) const {
    const TablePosition at = table_position(std::sqrt(cosine), kCosines);
    return at.mix(sheen_[at.index], sheen_[at.index + 1]);
  }

 private:
  static constexpr int kAlphas = 33;
  static constexpr int kCosines = 49;
  static constexpr int kAspects = 9;

  /// Of one aspect.
  struct Slice {
    std::array<std::array<GgxAlbedo, kCosines>, kAlphas> albedo;
    std::array<GgxAlbedo, kAlphas> mean;
    void integrate(float aspect);
  };
  using Slices = std::array<Slice, kAspects - 1>;  ///< from kLeastAspect on; the last aspect is 1

  static GgxAlbedo mix(const GgxAlbedo& a, const GgxAlbedo& b, float t) {
    return {a.f0 + t * (b.f0 - a.f0), a.f90 + t * (b.f90 - a.f90)};
  }

  /// `look_up` at the two slices around the aspect.
  template <class LookUp>
  GgxAlbedo at_shape(const GgxShape& shape, const LookUp& look_up) const {
    const TablePosition row = table_position(std::sqrt(shape.alpha), kAlphas);
    if (shape.aspect >= 1.0f) return look_up(isotropic_, row);
    const float share = (shape.aspect - kLeastAspect) / (1.0f - kLeastAspect);
    const TablePosition slice = table_position(std::max(0.0f, share), kAspects);
    const Slices& slices = anisotropic();
    const Slice& above = slice.index + 1 < kAspects - 1 ? slices[slice.index + 1] : isotropic_;
    return mix(look_up(slices[slice.index], row), look_up(above, row), slice.fraction);
  }

  PrincipledTables();
  static const Slices& anisotropic();

  Slice isotropic_;
  std::array<float, kCosines> sheen_;
};

}  // namespace becalm::tracer
