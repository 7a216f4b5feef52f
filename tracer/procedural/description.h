#pragma once

#include <cstdint>
#include <variant>

#include "tracer/math/keyframes.h"

// What a scene file says of procedural surfaces. All stand in object space, y up, around the origin.

namespace becalm::tracer {

/// Eroded mountains: a height field over |x|, |z| <= size / 2, from about 0 to `height`.
struct TerrainDescription {
  double size = 1.0;
  Curve<1> height{{0.2}};
  std::uint32_t seed = 0;
  double mountains = 4.0;   ///< along each side, roughly: the frequency of the coarsest noise
  int octaves = 9;          ///< of noise, 1 to 16; what is finer than the grid is left out
  Curve<1> erosion{{1.0}};  ///< depth of the gullies, 0 to 2
  int resolution = 2048;    ///< cells along each side: a power of two, 16 to 4096
};

/// A water surface over |x|, |z| <= size / 2 around height 0, of waves that obey deep water's dispersion.
struct OceanDescription {
  double size = 100.0;
  double wavelength = 10.0;  ///< of the strongest waves
  double shortest_wavelength = 0.25;
  Curve<1> wave_height{{0.5}};  ///< significant height: four standard deviations of the surface
  double wind_deg = 0.0;        ///< where waves run to, from +x towards +z
  double spread_deg = 30.0;     ///< standard deviation of directions at the strongest waves
  int trains = 48;              ///< 1 to kMostTrains
  std::uint32_t seed = 0;
  double gravity = 9.81;  ///< in object units / s^2
  Curve<1> time_s{{0.0}};
};

/// Balls that wander inside a sphere around the origin and melt into each other.
struct BlobsDescription {
  int count = 12;          ///< 1 to kMostBalls
  double extent = 1.0;     ///< centres stay this close to the origin
  Curve<1> radius{{0.3}};  ///< mean radius
  double variation = 0.4;  ///< radii differ by up to this part of the mean, 0 to 0.9
  double blend = 0.1;      ///< distance over which balls melt together
  std::uint32_t seed = 0;
  double speed = 0.2;  ///< mean turns / s of the paths
  Curve<1> time_s{{0.0}};
};

using ProceduralDescription = std::variant<TerrainDescription, OceanDescription, BlobsDescription>;

inline constexpr int kMostTrains = 64;
inline constexpr int kMostBalls = 64;

}  // namespace becalm::tracer
