#include "tracer/scene/load/load_media.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/error_of.h"

namespace becalm::tracer {
namespace {

MediumDescription read(std::string text) {
  std::replace(text.begin(), text.end(), '\'', '"');
  const std::string file = "s.json";
  const nlohmann::json document = nlohmann::json::parse(text);
  return read_medium(JsonValue(document, file, "/media/m"));
}

std::string message(const std::string& text) {
  return error_of(ExitStatus::bad_input, [&] { read(text); });
}

TEST(LoadMedia, ReadsHomogeneous) {
  const auto medium = std::get<HomogeneousMedium>(
      read("{'type': 'homogeneous', 'extinction': [1, 2, 0], 'albedo': 0.5, 'g': -0.25}"));
  EXPECT_EQ(medium, (HomogeneousMedium{V3f(1, 2, 0), V3f(0.5f), -0.25f}));
}

TEST(LoadMedia, ReadsCloud) {
  const auto cloud = std::get<CloudDescription>(
      read("{'type': 'cloud', 'extinction': {'keys': [{'frame': 1, 'value': 2}, {'frame': 2, 'value': 4}]}, "
           "'albedo': "
           "[1, 0.5, 0], 'g': 0.8, 'resolution': [32, 16, 48], 'frequency': [4, 2, 4], 'offset': {'keys': "
           "[{'frame': 0, "
           "'value': [0, 0, 0]}, {'frame': 10, 'value': [1, 0, 0]}]}, 'evolution': 0.5, 'coverage': 0.4, "
           "'octaves': 3, "
           "'lacunarity': 2, 'gain': 0.6, 'softness': 0.1, 'edge': 0.2, 'seed': 7}"));
  CloudShape shape;
  shape.resolution = {32, 16, 48};
  shape.frequency = {4, 2, 4};
  shape.octaves = 3;
  shape.lacunarity = 2.0f;
  shape.gain = 0.6f;
  shape.softness = 0.1f;
  shape.edge = 0.2f;
  shape.seed = 7;
  EXPECT_TRUE(cloud.shape == shape);
  EXPECT_EQ(cloud.extinction.at(1.5)[0], 3.0);
  EXPECT_EQ(cloud.offset.at(5.0)[0], 0.5);
  EXPECT_EQ(cloud.evolution.at(0.0)[0], 0.5);
  EXPECT_EQ(cloud.coverage.at(0.0)[0], 0.4);
  EXPECT_EQ(cloud.albedo, V3f(1.0f, 0.5f, 0.0f));
  EXPECT_EQ(cloud.g, 0.8f);
}

TEST(LoadMedia, NamesWhatIsWrong) {
  const auto expect = [](const std::string& text, const std::string& start) {
    const std::string found = message(text);
    EXPECT_EQ(found.substr(0, start.size()), start) << found;
  };
  const std::string fog = "{'type': 'homogeneous', 'albedo': 1, ";
  const std::string cloud = "{'type': 'cloud', 'extinction': 1, ";
  expect("{'type': 'smoke'}", "s.json: /media/m/type: ");
  expect("{'type': 'homogeneous', 'albedo': 1}", "s.json: /media/m");
  expect(fog + "'extinction': -1}", "s.json: /media/m/extinction: ");
  expect(fog + "'extinction': 1e31}", "s.json: /media/m/extinction: ");
  expect(fog + "'extinction': 1, 'g': 1}", "s.json: /media/m/g: ");
  expect(fog + "'extinction': 1, 'coverage': 1}", "s.json: /media/m");
  expect("{'type': 'homogeneous', 'extinction': 1, 'albedo': [0, 0, 1.5]}", "s.json: /media/m/albedo/2: ");
  expect(cloud + "'resolution': [1, 8, 8]}", "s.json: /media/m/resolution/0: ");
  expect(cloud + "'resolution': [8, 8]}", "s.json: /media/m/resolution: expected 3 numbers");
  expect(cloud + "'resolution': [1024, 1024, 1024]}",
         "s.json: /media/m/resolution: expected at most 134217728");
  expect(cloud + "'octaves': 0}", "s.json: /media/m/octaves: ");
  expect(cloud + "'softness': 0}", "s.json: /media/m/softness: ");
  expect(cloud + "'coverage': {'keys': [{'frame': 1, 'value': 2}]}}",
         "s.json: /media/m/coverage/keys/0/value: ");
}

}  // namespace
}  // namespace becalm::tracer
