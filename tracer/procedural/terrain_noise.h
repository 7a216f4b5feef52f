#pragma once

#include <cstdint>
#include <vector>

namespace becalm::tracer {

/// What shapes mountains, in units of a square of side 1.
struct TerrainShape {
  std::uint32_t seed;
  float mountains;  ///< coarsest noise's frequency
  int octaves;
  float erosion;   ///< depth of the gullies
  int resolution;  ///< cells along the side: octaves above a third of it are left out

  bool operator==(const TerrainShape&) const = default;
};

/// Controls of the biquadratic B-spline through such mountains, (resolution + 2)^2 in rows: one at each
/// cell's centre and a ring around. Heights are mostly within [0, 1]. Rows are made in parallel; the result
/// does not depend on how many at once.
std::vector<float> make_mountains(const TerrainShape& shape);

}  // namespace becalm::tracer
