// The aligner as a service: reads one JSON command a line, answers with one JSON line each, so that a script
// can hold several of these, give them data and interleave their runs with those of other programs. Needs
// nothing but a Vulkan driver.
//
//   {"do": "device"}
//   {"do": "build", "input": "plane" | "frames", "width": W, "height": H, "preset": NAME, "set":
//   ["KEY=VALUE"],
//    "aovs": ["albedo", "normal"], "alias": true}
//   {"do": "load", "target": {LAYER: FILE}, "source": {LAYER: FILE}}     raw little-endian floats,
//   interleaved
//   {"do": "load", "pattern": [DX, DY]}              "plane" alone: a random pattern displaced by (DX, DY) px
//   {"do": "run", "times": N}                        medians over N runs
//   {"do": "save", "offset": FILE, "residual": FILE}
//
// A command that fails is answered by {"error": MESSAGE}; the next one is read all the same.

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "filter/align.h"
#include "frame/error.h"
#include "tests/bench/align_job.h"
#include "tests/bench/stopwatch.h"
#include "tests/filter/pattern.h"

namespace becalm::bench {
namespace {

using nlohmann::json;

Image read_raw(const std::string& path, gpu::Extent extent) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw Error(ExitStatus::bad_input, fmt::format("{}: cannot be read", path));
  const auto bytes = static_cast<std::uint64_t>(file.tellg());
  const std::uint64_t plane = extent.elements() * sizeof(float);
  if (bytes == 0 || bytes % plane != 0 || bytes / plane > 4) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: {} bytes: expected {} times 1 to 4 channels", path, bytes, plane));
  }
  Image image(extent.width, extent.height, static_cast<int>(bytes / plane));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(image.data().data()), static_cast<std::streamsize>(bytes));
  return image;
}

void write_raw(const std::string& path, const Image& image) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(image.data().data()),
             static_cast<std::streamsize>(image.data().size_bytes()));
  if (!file.flush()) throw Error(ExitStatus::resource, fmt::format("{}: cannot be written", path));
}

Layers read_layers(const json& files, gpu::Extent extent) {
  Layers layers;
  for (const auto& [name, path] : files.items()) layers.emplace(name, read_raw(path, extent));
  return layers;
}

Layers pattern_layers(gpu::Extent extent, double dx, double dy) {
  Image image(extent.width, extent.height, 1);
  const auto grid = pattern_image(extent.width, extent.height, {-dx, -dy}, 3);
  std::ranges::copy(grid.data, image.data().begin());
  Layers layers;
  layers.emplace("plane", std::move(image));
  return layers;
}

class Service {
 public:
  explicit Service(const std::string& device) : device_({.select = device, .validation = false}) {}

  json answer(const json& command) {
    const std::string what = command.at("do");
    if (what == "device") return describe_device();
    if (what == "build") return build(command);
    if (!job_) throw Error(ExitStatus::usage, "nothing is built");
    if (what == "load") return load(command);
    if (what == "run") return run(command.value("times", 1));
    if (what == "save") return save(command);
    throw Error(ExitStatus::usage, fmt::format("no command '{}'", what));
  }

 private:
  json describe_device() const {
    const gpu::DeviceInfo& info = device_.info();
    return {{"name", info.name}, {"type", info.type}, {"driver", info.driver}};
  }

  json build(const json& command) {
    full_ = {command.at("width"), command.at("height")};
    if (full_.width < 1 || full_.height < 1) throw Error(ExitStatus::usage, "the size is not positive");
    filter::Settings settings = filter::preset(command.value("preset", "final"));
    for (const std::string assignment : command.value("set", json::array()))
      filter::set(settings, assignment);
    const std::string input = command.at("input");
    job_.reset();  // before the next one asks for memory
    if (input == "plane") {
      job_ = make_plane_job(device_, settings, full_, command.value("alias", true));
    } else if (input == "frames") {
      job_ = make_frame_job(device_, settings, full_, command.value("aovs", std::vector<std::string>()));
    } else {
      throw Error(ExitStatus::usage, fmt::format("no input '{}'", input));
    }
    json levels = json::array();
    for (const gpu::Extent& extent : filter::pyramid_extents(settings, full_.width, full_.height)) {
      levels.push_back({extent.width, extent.height});
    }
    return {{"settings", filter::to_string(settings)},
            {"reach_px", filter::reach_px(settings, levels.size())},
            {"levels", levels},
            {"device_bytes", job_->device_bytes()},
            {"device_bytes_unaliased", job_->device_bytes_unaliased()}};
  }

  json load(const json& command) {
    if (command.contains("pattern")) {
      const json& shift = command.at("pattern");
      job_->load(pattern_layers(full_, 0.0, 0.0), pattern_layers(full_, shift.at(0), shift.at(1)));
    } else {
      job_->load(read_layers(command.at("target"), full_), read_layers(command.at("source"), full_));
    }
    return {{"loaded", true}};
  }

  json run(int times) {
    if (times < 1) throw Error(ExitStatus::usage, "times is not positive");
    std::vector<double> wall, device;
    std::vector<std::vector<double>> passes;
    for (int i = 0; i < times; ++i) {
      wall.push_back(1e3 * time_of([&] { job_->run(); }).wall_s);
      device.push_back(0.0);
      const std::vector<gpu::PassTime> run = job_->passes();
      passes.resize(run.size());
      for (std::size_t p = 0; p < run.size(); ++p) {
        passes[p].push_back(run[p].milliseconds);
        device.back() += run[p].milliseconds;
      }
    }
    json rows = json::array();
    const std::vector<gpu::PassTime> last = job_->passes();
    for (std::size_t p = 0; p < last.size(); ++p) {
      rows.push_back(
          {{"name", last[p].name}, {"ms", median(passes[p])}, {"image_bytes", last[p].image_bytes}});
    }
    return {{"wall_ms", median(wall)}, {"device_ms", median(device)}, {"passes", rows}};
  }

  json save(const json& command) {
    if (job_->passes().empty() || job_->offset().empty()) throw Error(ExitStatus::usage, "nothing has run");
    if (command.contains("offset")) write_raw(command.at("offset"), job_->offset());
    if (command.contains("residual")) write_raw(command.at("residual"), job_->residual());
    return {{"saved", true}};
  }

  gpu::Device device_;
  gpu::Extent full_;
  std::unique_ptr<AlignJob> job_;
};

void serve(const std::string& device) {
  Service service(device);
  for (std::string line; std::getline(std::cin, line);) {
    json answer;
    try {
      answer = service.answer(json::parse(line));
    } catch (const std::exception& error) {
      answer = {{"error", error.what()}};
    }
    fmt::print("{}\n", answer.dump());
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace becalm::bench

int main(int argc, char** argv) {
  if (argc > 2) {
    std::fputs("usage: bench_align [DEVICE] <commands; DEVICE: its index or part of its name\n", stderr);
    return 2;
  }
  try {
    becalm::bench::serve(argc > 1 ? argv[1] : "");
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_align: %s\n", error.what());
    return 4;
  }
}
