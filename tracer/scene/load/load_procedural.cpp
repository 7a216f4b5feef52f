#include "tracer/scene/load/load_procedural.h"

#include <bit>

#include "tracer/scene/load/load_values.h"

namespace becalm::tracer {

namespace {

// Lengths whose squares and quotients by each other stay finite in float.
constexpr double kSmallest = 1e-9, kLargest = 1e12;
constexpr double kLongestTime_s = 1e6;  ///< phases keep a thousandth of a turn
constexpr int kMostSeed = (1 << 24) - 1;

double number_or(const JsonValue& json, const char* key, double low, double high, double otherwise) {
  const auto value = json.find(key);
  return value ? value->number(low, high) : otherwise;
}

int integer_or(const JsonValue& json, const char* key, int low, int high, int otherwise) {
  const auto value = json.find(key);
  return value ? value->integer(low, high) : otherwise;
}

void read_curve_into(Curve<1>& curve, const JsonValue& json, const char* key, double low, double high) {
  if (const auto value = json.find(key)) curve = read_number_curve(*value, low, high);
}

std::uint32_t read_seed(const JsonValue& json) {
  return static_cast<std::uint32_t>(integer_or(json, "seed", 0, kMostSeed, 0));
}

TerrainDescription read_terrain(const JsonValue& json) {
  json.allow_keys({"procedural", "size", "height", "seed", "mountains", "octaves", "erosion", "resolution"});
  TerrainDescription terrain;
  terrain.size = number_or(json, "size", kSmallest, kLargest, terrain.size);
  // By default a fifth of the size.
  terrain.height = Curve<1>::Value{0.2 * terrain.size};
  read_curve_into(terrain.height, json, "height", 0.0, 10.0 * terrain.size);
  terrain.seed = read_seed(json);
  terrain.mountains = number_or(json, "mountains", 0.5, 256.0, terrain.mountains);
  terrain.octaves = integer_or(json, "octaves", 1, 16, terrain.octaves);
  read_curve_into(terrain.erosion, json, "erosion", 0.0, 2.0);
  terrain.resolution = integer_or(json, "resolution", 16, 4096, terrain.resolution);
  if (!std::has_single_bit(static_cast<unsigned>(terrain.resolution))) {
    json.at("resolution").fail(fmt::format("expected a power of two, found {}", terrain.resolution));
  }
  return terrain;
}

OceanDescription read_ocean(const JsonValue& json) {
  json.allow_keys({"procedural", "size", "wavelength", "shortest_wavelength", "wave_height", "wind_deg",
                   "spread_deg", "trains", "seed", "gravity", "time_s"});
  OceanDescription ocean;
  ocean.size = json.at("size").number(kSmallest, kLargest);
  // Float coordinates are too coarse for waves shorter than these limits.
  ocean.wavelength = json.at("wavelength").number(1e-3 * ocean.size, ocean.size);
  ocean.shortest_wavelength = number_or(json, "shortest_wavelength", 1e-4 * ocean.size, ocean.wavelength,
                                        std::max(1e-4 * ocean.size, ocean.wavelength / 40.0));
  ocean.wave_height = Curve<1>::Value{0.05 * ocean.wavelength};
  read_curve_into(ocean.wave_height, json, "wave_height", 0.0, ocean.wavelength);
  ocean.wind_deg = number_or(json, "wind_deg", -360.0, 360.0, ocean.wind_deg);
  ocean.spread_deg = number_or(json, "spread_deg", 0.0, 180.0, ocean.spread_deg);
  ocean.trains = integer_or(json, "trains", 1, kMostTrains, ocean.trains);
  ocean.seed = read_seed(json);
  ocean.gravity = number_or(json, "gravity", 0.0, 1e6, ocean.gravity);
  read_curve_into(ocean.time_s, json, "time_s", -kLongestTime_s, kLongestTime_s);
  return ocean;
}

BlobsDescription read_blobs(const JsonValue& json) {
  json.allow_keys(
      {"procedural", "count", "extent", "radius", "variation", "blend", "seed", "speed", "time_s"});
  BlobsDescription blobs;
  blobs.count = integer_or(json, "count", 1, kMostBalls, blobs.count);
  blobs.extent = number_or(json, "extent", kSmallest, kLargest, blobs.extent);
  // Radii and blend are limited relative to the extent: the field is marched in float.
  blobs.radius = Curve<1>::Value{0.3 * blobs.extent};
  read_curve_into(blobs.radius, json, "radius", 1e-3 * blobs.extent, 1e3 * blobs.extent);
  blobs.variation = number_or(json, "variation", 0.0, 0.9, blobs.variation);
  blobs.blend = number_or(json, "blend", 1e-3 * blobs.extent, 10.0 * blobs.extent, 0.1 * blobs.extent);
  blobs.seed = read_seed(json);
  blobs.speed = number_or(json, "speed", 0.0, 1e3, blobs.speed);
  read_curve_into(blobs.time_s, json, "time_s", -kLongestTime_s, kLongestTime_s);
  return blobs;
}

}  // namespace

ProceduralDescription read_procedural(const JsonValue& json) {
  switch (json.at("procedural").choice({"terrain", "ocean", "blobs"})) {
    case 0:
      return read_terrain(json);
    case 1:
      return read_ocean(json);
    default:
      return read_blobs(json);
  }
}

}  // namespace becalm::tracer
