#include "tracer/scene/load/load_media.h"

namespace becalm::tracer {

namespace {

constexpr double kLargestExtinction = 1e30;
/// 512 MiB of 32-bit densities.
constexpr double kMostVoxels = 1 << 27;
constexpr int kMostVoxelsOnAxis = 4096;
/// Noise coordinates stay below 2^52, where lattice cells are exact: 1e6 * 1e3 * 4^10 is a quarter of it.
constexpr double kLargestOffset = 1e6;
constexpr double kLargestFrequency = 1e3;
constexpr double kLargestLacunarity = 4.0;
static_assert(kMostCloudOctaves == 11);

/// In (-1,1). Float leaves no number between 1 - 2^-24 and 1, and near 1 the lobe is narrower than directions
/// of 32 bits can tell apart.
float read_mean_cosine(const JsonValue& json) {
  const auto g = json.find("g");
  return g ? static_cast<float>(g->number(-0.999, 0.999)) : 0.0f;
}

HomogeneousMedium read_homogeneous(const JsonValue& json) {
  json.allow_keys({"type", "extinction", "albedo", "g"});
  return {read_color(json.at("extinction"), kLargestExtinction), read_color(json.at("albedo"), 1.0),
          read_mean_cosine(json)};
}

V3i read_resolution(const JsonValue& json) {
  const std::vector<JsonValue> elements = json.elements();
  if (elements.size() != 3) json.fail(fmt::format("expected 3 numbers of voxels, found {}", elements.size()));
  V3i resolution;
  double voxels = 1.0;
  for (int a = 0; a < 3; ++a) {
    resolution[a] = elements[a].integer(2, kMostVoxelsOnAxis);
    voxels *= resolution[a];
  }
  if (voxels > kMostVoxels) {
    json.fail(fmt::format("expected at most {:.0f} voxels, found {:.0f}", kMostVoxels, voxels));
  }
  return resolution;
}

CloudDescription read_cloud(const JsonValue& json) {
  json.allow_keys({"type", "extinction", "albedo", "g", "resolution", "frequency", "offset", "evolution",
                   "coverage", "octaves", "lacunarity", "gain", "softness", "edge", "seed"});
  CloudDescription cloud;
  cloud.extinction = read_number_curve(json.at("extinction"), 0.0, kLargestExtinction);
  if (const auto v = json.find("albedo")) cloud.albedo = read_color(*v, 1.0);
  cloud.g = read_mean_cosine(json);
  if (const auto v = json.find("offset"))
    cloud.offset = read_triple_curve(*v, -kLargestOffset, kLargestOffset);
  if (const auto v = json.find("evolution")) {
    cloud.evolution = read_number_curve(*v, -kLargestOffset, kLargestOffset);
  }
  if (const auto v = json.find("coverage")) cloud.coverage = read_number_curve(*v, 0.0, 1.0);

  CloudShape& shape = cloud.shape;
  const auto number = [&](const char* key, double low, double high, float& to) {
    if (const auto v = json.find(key)) to = static_cast<float>(v->number(low, high));
  };
  if (const auto v = json.find("resolution")) shape.resolution = read_resolution(*v);
  if (const auto v = json.find("frequency")) shape.frequency = to_v3f(v->triple(0.0, kLargestFrequency));
  if (const auto v = json.find("octaves")) shape.octaves = v->integer(1, kMostCloudOctaves);
  number("lacunarity", 1.0, kLargestLacunarity, shape.lacunarity);
  number("gain", 0.0, 1.0, shape.gain);
  number("softness", 1e-3, 1e3, shape.softness);
  number("edge", 1e-3, 1.0, shape.edge);
  if (const auto v = json.find("seed")) {
    shape.seed = static_cast<std::uint32_t>(v->integer(0, std::numeric_limits<int>::max()));
  }
  return cloud;
}

}  // namespace

MediumDescription read_medium(const JsonValue& json) {
  const std::size_t type = json.at("type").choice({"homogeneous", "cloud"});
  if (type == 0) return read_homogeneous(json);
  return read_cloud(json);
}

}  // namespace becalm::tracer
