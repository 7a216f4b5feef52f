#pragma once

#include <string>
#include <vector>

#include "tracer/procedural/procedural.h"

namespace becalm::tracer::test {

inline Curve<1> constant(double value) {
  return Curve<1>::Value{value};
}

/// A field of each kind that is `size` across, small enough to be made in a moment.
struct NamedField {
  std::string name;
  double size;
  ProceduralDescription description;
};

inline TerrainDescription small_terrain(double size) {
  TerrainDescription terrain;
  terrain.size = size;
  terrain.height = constant(0.25 * size);
  terrain.resolution = 128;
  terrain.seed = 7;
  return terrain;
}

inline OceanDescription small_ocean(double size) {
  OceanDescription ocean;
  ocean.size = size;
  ocean.wavelength = 0.15 * size;
  ocean.shortest_wavelength = 0.01 * size;
  ocean.wave_height = constant(0.02 * size);
  ocean.trains = 21;
  ocean.gravity = size;
  return ocean;
}

inline BlobsDescription small_blobs(double size) {
  BlobsDescription blobs;
  blobs.count = 9;
  blobs.extent = 0.35 * size;
  blobs.radius = constant(0.12 * size);
  blobs.blend = 0.03 * size;
  blobs.seed = 5;
  return blobs;
}

inline std::vector<NamedField> small_fields(double size) {
  return {{"terrain", size, small_terrain(size)},
          {"ocean", size, small_ocean(size)},
          {"blobs", size, small_blobs(size)}};
}

inline Procedural made(const ProceduralDescription& description, double frame = 0.0) {
  Procedural procedural;
  update(description, frame, procedural);
  return procedural;
}

/// Numbers in [0, 1) for tests.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2 + 1) {}
  float operator()() {
    state_ = state_ * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<float>(state_ >> 40) * 0x1p-24f;
  }
  float between(float a, float b) { return a + (b - a) * (*this)(); }

 private:
  std::uint64_t state_;
};

}  // namespace becalm::tracer::test
