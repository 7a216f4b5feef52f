#pragma once

#include <cstdint>

namespace becalm::tracer {

/// What shapes mountains, in units of a square of side 1.
struct TerrainShape {
  std::uint32_t seed;
  float mountains;   ///< coarsest noise's frequency
  int octaves;
  float erosion;     ///< depth of the gullies
  float resolution;  ///< samples along the side: octaves above half of it are left out

  bool operator==(const TerrainShape&) const = default;
};

/// Height at a point, in mountain heights: mostly within [0, 1].
float terrain_height(const TerrainShape& shape, float x, float z);

}  // namespace becalm::tracer
