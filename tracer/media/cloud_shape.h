#pragma once

#include <array>
#include <cstdint>

#include "tracer/math/vec.h"
#include "tracer/media/density_grid.h"

namespace becalm::tracer {

inline constexpr int kMostCloudOctaves = 11;

/// Cumulus clouds in the box [-1,1]^3 (y up) as a density in [0,1]: one octave of gradient noise says where
/// they are, and a threshold that rises with the square of the height rounds them into domes over a flat
/// base; octaves of billow noise (absolute values, whose creases point inward) make the domes' surface bulge.
/// At the box's border the density is 0.
struct CloudShape {
  V3i resolution{128, 64, 128};  ///< voxels, each axis from 2
  V3f frequency{3.0f};           ///< noise cells from the box's centre to its side, of the first octave
  V3f offset{0.0f};              ///< the pattern's drift in the box's coordinates
  float evolution = 0.0f;        ///< cells of the first octave along the noise's fourth axis
  float coverage = 0.5f;         ///< 0: no clouds, 1: hardly a gap
  int octaves = 6;               ///< 1 to kMostCloudOctaves
  float lacunarity = 2.1f;       ///< ratio of frequencies from octave to octave
  float gain = 0.5f;             ///< ratio of amplitudes
  float softness =
      0.2f;  ///< rise of the field from the clouds' surface to density 1, above 0; noise is of size 1
  float edge = 0.3f;  ///< width of the clear rim along the sides in the box's coordinates, above 0
  std::uint32_t seed = 0;

  bool operator==(const CloudShape&) const = default;
};

/// The density that the grid's voxels sample.
class CloudDensity {
 public:
  explicit CloudDensity(const CloudShape& shape);

  float operator()(const V3f& point) const;

 private:
  struct Octave {
    V3d frequency;
    double evolution;
    std::uint32_t seed;
    float amplitude;
    float remaining;  ///< amplitude of this octave and those to come
  };

  float noise(int octave, const V3f& point) const;

  CloudShape shape_;
  float bias_;  ///< what coverage adds to the field
  std::array<Octave, kMostCloudOctaves> octaves_;
};

/// Runs in parallel; the same bits for any number of threads.
DensityGrid bake_cloud(const CloudShape& shape);

}  // namespace becalm::tracer
