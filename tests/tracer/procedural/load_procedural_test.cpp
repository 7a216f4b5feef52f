#include "tracer/scene/load/load_procedural.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/error_of.h"

namespace becalm::tracer {
namespace {

ProceduralDescription read(const std::string& text) {
  const nlohmann::json json = nlohmann::json::parse(text);
  const std::string file = "scene.json";
  return read_procedural(JsonValue(json, file, "/meshes/land"));
}

std::string error_of(const std::string& text) {
  return becalm::error_of(ExitStatus::bad_input, [&] { read(text); });
}

TEST(LoadProcedural, ReadsEveryKey) {
  const auto terrain = std::get<TerrainDescription>(read(
      R"({"procedural": "terrain", "size": 8, "height": {"keys": [{"frame": 0, "value": 1}, {"frame": 2, "value": 3}]},
               "seed": 3, "mountains": 5, "octaves": 6, "erosion": 0.5, "resolution": 256})"));
  EXPECT_EQ(terrain.size, 8.0);
  EXPECT_EQ(terrain.height.at(1)[0], 2.0);
  EXPECT_EQ(terrain.seed, 3u);
  EXPECT_EQ(terrain.mountains, 5.0);
  EXPECT_EQ(terrain.octaves, 6);
  EXPECT_EQ(terrain.erosion.at(0)[0], 0.5);
  EXPECT_EQ(terrain.resolution, 256);
  const auto ocean = std::get<OceanDescription>(read(
      R"({"procedural": "ocean", "size": 100, "wavelength": 9, "shortest_wavelength": 0.5, "wave_height": 2,
               "wind_deg": 45, "spread_deg": 20, "trains": 30, "seed": 4, "gravity": 1.6, "time_s": 7})"));
  EXPECT_EQ(ocean.size, 100.0);
  EXPECT_EQ(ocean.wavelength, 9.0);
  EXPECT_EQ(ocean.shortest_wavelength, 0.5);
  EXPECT_EQ(ocean.wave_height.at(0)[0], 2.0);
  EXPECT_EQ(ocean.wind_deg, 45.0);
  EXPECT_EQ(ocean.spread_deg, 20.0);
  EXPECT_EQ(ocean.trains, 30);
  EXPECT_EQ(ocean.seed, 4u);
  EXPECT_EQ(ocean.gravity, 1.6);
  EXPECT_EQ(ocean.time_s.at(0)[0], 7.0);
  const auto blobs = std::get<BlobsDescription>(
      read(R"({"procedural": "blobs", "count": 3, "extent": 2, "radius": 0.7, "variation": 0.1, "blend": 0.3,
               "seed": 9, "speed": 0.4, "time_s": 5})"));
  EXPECT_EQ(blobs.count, 3);
  EXPECT_EQ(blobs.extent, 2.0);
  EXPECT_EQ(blobs.radius.at(0)[0], 0.7);
  EXPECT_EQ(blobs.variation, 0.1);
  EXPECT_EQ(blobs.blend, 0.3);
  EXPECT_EQ(blobs.seed, 9u);
  EXPECT_EQ(blobs.speed, 0.4);
  EXPECT_EQ(blobs.time_s.at(0)[0], 5.0);
}

TEST(LoadProcedural, SaysWhatIsWrongAndWhere) {
  EXPECT_NE(error_of(R"({"procedural": "lake"})").find("scene.json: /meshes/land/procedural: "),
            std::string::npos);
  EXPECT_NE(error_of(R"({"procedural": "terrain", "trains": 3})").find("/meshes/land"), std::string::npos);
  EXPECT_EQ(error_of(R"({"procedural": "terrain", "resolution": 100})"),
            "scene.json: /meshes/land/resolution: expected a power of two, found 100");
  EXPECT_NE(error_of(R"({"procedural": "ocean", "size": 10})").find("wavelength"), std::string::npos);
  EXPECT_NE(
      error_of(R"({"procedural": "ocean", "size": 10, "wavelength": 20})").find("/meshes/land/wavelength: "),
      std::string::npos);
  EXPECT_NE(error_of(R"({"procedural": "blobs", "radius": 0})").find("/meshes/land/radius: "),
            std::string::npos);
}

}  // namespace
}  // namespace becalm::tracer
