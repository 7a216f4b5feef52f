#include "app/adaptive_sampling.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "app/cancel.h"
#include "app/expected_error.h"
#include "filter/input/host_images.h"
#include "filter/input/radiance_scale.h"

namespace becalm::app {

namespace {

constexpr int kPilotSpp = 2;
constexpr int kPilotScale = 2;  ///< of the frame's width and height over the pilot's
/// Added to the seed, which users count up from 0.
constexpr std::uint32_t kPilotSeed = 0x70110700u;
/// Samples of a pixel over their mean.
constexpr double kFewest = 0.25;
constexpr double kMost = 8.0;

filter::Settings pilot_settings() {
  return filter::preset("draft");
}

tracer::RenderOptions pilot_of(tracer::RenderOptions render) {
  render.width = std::max(1, (render.width + kPilotScale - 1) / kPilotScale);
  render.height = std::max(1, (render.height + kPilotScale - 1) / kPilotScale);
  render.spp = kPilotSpp;
  render.aov_spp = std::min(render.aov_spp, kPilotScale * kPilotScale * kPilotSpp);
  render.seed += kPilotSeed;
  render.aovs = filter::wanted_aovs(pilot_settings());
  render.light_groups = false;
  render.cancel = &stop_requested();
  return render;
}

}  // namespace

AdaptiveSampling::AdaptiveSampling(tracer::Scene& scene, tracer::RenderOptions render,
                                   const FilterOptions& filter, const Options& options)
    : scene_(scene),
      width_(render.width),
      height_(render.height),
      pilot_options_(pilot_of(std::move(render))),
      options_(options),
      memory_limit_(filter),
      device_options_(device_options(filter)) {}

std::optional<Image> AdaptiveSampling::counts(int frame) {
  std::optional<Frame> noisy = render_pilot(frame);
  if (!noisy) return std::nullopt;
  if (const float scale = filter::radiance_scale(*noisy); scale != 1.0f)
    filter::scale_radiance(*noisy, scale);
  if (!filter_) {
    device_.emplace(device_options_);
    filter_.emplace(*device_, pilot_settings(), noisy->width(), noisy->height(), pilot_options_.aovs,
                    filter::SequenceOptions{.memory_limit = memory_limit_.bytes_of(*device_)});
  }
  filter::FrameReport report;
  const std::optional<Frame> filtered = filter_->run({.frame = frame, .new_history = true}, *noisy, report);
  const tracer::Pilot pilot{expected_error(*filtered, filter::exposure(noisy->image(Aov::beauty))),
                            pilot_spp()};
  const int least = options_.halves ? 2 : 1;
  if (options_.noise_target) {
    const int most = std::max(least, options_.spp);
    Image counts = tracer::counts_of_target(pilot, width_, height_, *options_.noise_target,
                                            {.least = least, .most = most});
    add_spent(counts, most);
    return counts;
  }
  const auto limit = [&](double factor) {
    return std::clamp(static_cast<int>(factor * options_.spp), least, tracer::kMostSamples);
  };
  return tracer::counts_of_mean(pilot, width_, height_, std::max(options_.spp, least),
                                {.least = limit(kFewest), .most = limit(kMost)});
}

void AdaptiveSampling::add_spent(const Image& counts, int most) {
  const auto pixels = static_cast<double>(counts.pixel_count());
  spent_.frames += 1.0;
  spent_.spp += std::accumulate(counts.data().begin(), counts.data().end(), 0.0) / pixels;
  spent_.capped += static_cast<double>(std::ranges::count(counts.data(), static_cast<float>(most))) / pixels;
}

std::optional<Frame> AdaptiveSampling::render_pilot(int frame, tracer::RenderReport* report) {
  return tracer::render_frame(scene_, frame, pilot_options_, report);
}

double AdaptiveSampling::pilot_spp() {
  return double(kPilotSpp) / (kPilotScale * kPilotScale);
}

}  // namespace becalm::app
