// The aligner as a service: reads JSON commands, one a line, and answers each with a line of JSON. A script
// can keep several of these processes and alternate between them and other programs.
//
//   {"do": "device"}
//   {"do": "build", "input": "plane" | "frames", "width": W, "height": H, "preset": NAME,
//    "set": ["KEY=VALUE"], "aovs": ["albedo", "normal"], "alias": true}
//   {"do": "load", "target": {LAYER: FILE}, "source": {LAYER: FILE}}     as read_raw
//   {"do": "load", "pattern": [DX, DY]}              "plane" alone: a random pattern displaced by (DX, DY) px
//   {"do": "run", "times": N}                        medians over N runs
//   {"do": "save", "offset": FILE, "residual": FILE}

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "filter/align/align.h"
#include "frame/error.h"
#include "scripts/benches/align/job.h"
#include "scripts/benches/json_service.h"
#include "scripts/benches/raw_image.h"
#include "scripts/benches/stopwatch.h"
#include "tests/filter/pattern.h"

namespace becalm::bench {
namespace {

using nlohmann::json;

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
      job_->prepare();
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

}  // namespace
}  // namespace becalm::bench

int main(int argc, char** argv) {
  if (argc > 2) {
    std::fputs("usage: bench_align [DEVICE] <commands; DEVICE: its index or part of its name\n", stderr);
    return 2;
  }
  return becalm::bench::serve<becalm::bench::Service>("bench_align", argc > 1 ? argv[1] : "");
}
