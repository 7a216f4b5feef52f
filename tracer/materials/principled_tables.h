#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace becalm::tracer {

/// What a GGX microsurface under Schlick's Fresnel reflects of uniform light after one scattering:
/// f0 F0 + f90 F90.
struct GgxAlbedo {
  float f0;
  float f90;
};

/// Albedos of the principled model's lobes, integrated when first asked for (about 0.1 s) and interpolated
/// linearly. Axes are the square roots of alpha and of the cosine, since albedos bend where cos is about
/// alpha.
class PrincipledTables {
 public:
  static const PrincipledTables& get();

  /// At a cosine in [0,1] of an isotropic lobe of width alpha in [0,1].
  GgxAlbedo albedo(float cosine, float alpha) const {
    const Position row = position(alpha), column = position(cosine);
    const GgxAlbedo low =
        mix(ggx_[row.index][column.index], ggx_[row.index][column.index + 1], column.fraction);
    const GgxAlbedo high =
        mix(ggx_[row.index + 1][column.index], ggx_[row.index + 1][column.index + 1], column.fraction);
    return mix(low, high, row.fraction);
  }
  /// Its mean over the hemisphere, weighed by the cosine: exactly that of the interpolated numbers.
  GgxAlbedo mean_albedo(float alpha) const {
    const Position row = position(alpha);
    return mix(ggx_mean_[row.index], ggx_mean_[row.index + 1], row.fraction);
  }
  /// Of a sheen (1 - cos(difference))^5, which is its value and not divided by pi; below 0.4.
  float sheen_albedo(float cosine) const {
    const Position at = position(cosine);
    return sheen_[at.index] + at.fraction * (sheen_[at.index + 1] - sheen_[at.index]);
  }

 private:
  static constexpr int kSize = 33;

  struct Position {
    int index;
    float fraction;
  };
  static Position position(float v) {
    const float x = std::sqrt(v) * (kSize - 1);
    const int index = std::min(static_cast<int>(x), kSize - 2);
    return {index, x - static_cast<float>(index)};
  }
  static GgxAlbedo mix(const GgxAlbedo& a, const GgxAlbedo& b, float t) {
    return {a.f0 + t * (b.f0 - a.f0), a.f90 + t * (b.f90 - a.f90)};
  }

  PrincipledTables();

  std::array<std::array<GgxAlbedo, kSize>, kSize> ggx_;  ///< [alpha][cosine]
  std::array<GgxAlbedo, kSize> ggx_mean_;
  std::array<float, kSize> sheen_;
};

}  // namespace becalm::tracer
