#include "tests/tracer/test_scenes.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/error_of.h"

namespace becalm::tracer::test {

namespace {

std::string folder() {
  const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
  std::string path = testing::TempDir() + "becalm-" + std::to_string(getpid()) + "/" + info->name() + "/";
  std::filesystem::create_directories(path);
  return path;
}

/// Removes the files of all tests of this process.
class RemoveFiles : public testing::Environment {
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove_all(testing::TempDir() + "becalm-" + std::to_string(getpid()), ignored);
  }
};
const auto* const kRemoveFiles = testing::AddGlobalTestEnvironment(new RemoveFiles);

}  // namespace

std::string file_path(const std::string& name) {
  return folder() + name;
}

void write_uv_picture() {
  write_file("uv.ppm",
             "P3 4 2 255 255 0 0 0 255 0 0 0 255 255 255 0 0 255 255 255 0 255 90 90 90 255 255 255\n");
}

std::string write_file(const std::string& name, const std::string& text) {
  std::string path = file_path(name);
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

Scene load_text(const std::string& json) {
  std::string text = json;
  for (char& c : text) {
    if (c == '\'') c = '"';
  }
  return load_scene(write_file("scene.json", text));
}

std::string load_error(const std::string& json) {
  std::string message = error_of(ExitStatus::bad_input, [&] { load_text(json); });
  const std::string path = folder();
  for (std::size_t at; (at = message.find(path)) != std::string::npos;) message.erase(at, path.size());
  return message;
}

RenderOptions options(int spp, std::initializer_list<Aov> aovs, std::uint32_t seed) {
  RenderOptions result;
  result.spp = spp;
  result.seed = seed;
  for (const Aov aov : aovs) result.aovs.set(static_cast<std::size_t>(aov));
  return result;
}

Mean mean_radiance(const Frame& frame, int channel) {
  return mean_radiance(frame, channel, 0, 0, frame.width(), frame.height());
}

Mean mean_radiance(const Frame& frame, int channel, int x0, int y0, int x1, int y1) {
  double sum = 0.0, variance = 0.0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      sum += frame.image(Aov::beauty).at(x, y, channel);
      variance += frame.image(Aov::variance).at(x, y, channel);
    }
  }
  const double count = static_cast<double>(x1 - x0) * (y1 - y0);
  return {sum / count, std::sqrt(variance) / count};
}

}  // namespace becalm::tracer::test
