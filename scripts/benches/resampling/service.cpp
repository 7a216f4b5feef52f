// The merge's warp of the history as a service for scripts/bench resampling: reads JSON commands, one a line,
// and answers each with a line of JSON.
//
//   {"do": "build", "width": W, "height": H, "resample": "bilinear" | "catmull_rom" | "spline"}
//   {"do": "warp", "offset": [DX, DY], "from": FILE, "to": FILE}     as read_raw, RGBA

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "filter/merge/merge.h"
#include "filter/tiles/pixel_view.h"
#include "frame/error.h"
#include "scripts/benches/json_service.h"
#include "scripts/benches/raw_image.h"

namespace becalm::bench {
namespace {

using nlohmann::json;

/// The passes that warp a history without holes, by one offset for all pixels.
class WarpJob {
 public:
  WarpJob(gpu::Device& device, const filter::Settings& settings, gpu::Extent full)
      : full_(full), chain_(device, "warp") {
    offset_ = chain_.input("offset", gpu::Format::f32x2, full);
    color_ = chain_.input("history.color", gpu::Format::f32x4, full);
    stats_ = chain_.input("history.stats", gpu::Format::f32x2, full);
    warped_ =
        filter::add_warp_passes(chain_, settings, full, {.color = color_, .stats = stats_}, offset_).color;
    chain_.output(warped_);
    chain_.build();
  }

  void warp(float dx, float dy, const std::string& from, const std::string& to) {
    std::ranges::fill(chain_.upload<float>(stats_), 1.0f);
    const auto offsets = chain_.upload<float>(offset_);
    for (std::size_t i = 0; i < offsets.size(); i += 2) {
      offsets[i] = dx;
      offsets[i + 1] = dy;
    }
    const Image color = read_raw(from, full_);
    if (color.channels() != 4) throw Error(ExitStatus::bad_input, fmt::format("{}: expected RGBA", from));
    std::ranges::copy(color.data(), chain_.upload<float>(color_).begin());
    chain_.run();
    write_raw(to, filter::download(chain_, warped_, full_, 4));
  }

 private:
  gpu::Extent full_;
  gpu::Chain chain_;
  gpu::ImageId offset_, color_, stats_, warped_;
};

class Service {
 public:
  json answer(const json& command) {
    const std::string what = command.at("do");
    if (what == "build") {
      filter::Settings settings = filter::preset("final");
      const std::string name = command.at("resample");
      settings.resample = name == "spline"        ? filter::Resample::spline
                          : name == "catmull_rom" ? filter::Resample::catmull_rom
                                                  : filter::Resample::bilinear;
      job_ = std::make_unique<WarpJob>(device_, settings,
                                       gpu::Extent{command.at("width"), command.at("height")});
      return {{"built", true}};
    }
    if (what != "warp") throw Error(ExitStatus::usage, fmt::format("no command '{}'", what));
    if (!job_) throw Error(ExitStatus::usage, "nothing is built");
    const json& offset = command.at("offset");
    job_->warp(offset.at(0), offset.at(1), command.at("from"), command.at("to"));
    return {{"warped", true}};
  }

 private:
  gpu::Device device_{{.select = "", .validation = false}};
  std::unique_ptr<WarpJob> job_;
};

}  // namespace
}  // namespace becalm::bench

int main() {
  return becalm::bench::serve<becalm::bench::Service>("bench_resampling");
}
