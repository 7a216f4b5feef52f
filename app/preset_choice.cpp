#include "app/preset_choice.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <set>

#include "filter/gpu/device.h"
#include "filter/sequence/sequence_filter.h"
#include "tracer/sample_counts.h"

namespace becalm::app {

namespace {

constexpr int kLargestWidth = 384;
constexpr int kLargestHeight = 216;
/// Measured frames. Where both directions are searched, they are a segment, and one more on either side is
/// its warm-up: a quarter, as in default segments.
constexpr int kFrames = 4;

/// The centre of the frame.
Frame centre_of(const Frame& frame) {
  const int width = std::min(frame.width(), kLargestWidth);
  const int height = std::min(frame.height(), kLargestHeight);
  const int x0 = (frame.width() - width) / 2, y0 = (frame.height() - height) / 2;
  Frame part(frame.number(), width, height);
  for (const AovInfo& entry : kAovTable) {
    if (!frame.has(entry.aov)) continue;
    const Image& from = frame.image(entry.aov);
    Image& to = part.add(entry.aov);
    for (int y = 0; y < height; ++y) {
      const auto row = from.data().subspan(
          (static_cast<std::size_t>(y0 + y) * frame.width() + x0) * from.channels(), to.channels() * width);
      std::ranges::copy(row, to.data().begin() + static_cast<std::ptrdiff_t>(y) * to.channels() * width);
    }
  }
  return part;
}

double seconds_per_frame(gpu::Device& device, const filter::Settings& settings, std::uint64_t memory_limit,
                         const Frame& frame) {
  AovSet available;
  for (const AovInfo& entry : kAovTable) {
    if (frame.has(entry.aov)) available.set(static_cast<std::size_t>(entry.aov));
  }
  filter::SequenceFilter filter(device, settings, frame.width(), frame.height(), available,
                                {.memory_limit = memory_limit});
  const bool has_segments = settings.directions == filter::Directions::both;
  std::vector<int> present;
  std::set<int> wanted;
  for (int number = has_segments ? kFrames - 1 : kFrames; number <= 2 * kFrames; ++number) {
    present.push_back(number);
    if (number / kFrames == 1) wanted.insert(number);
  }
  const std::vector<filter::Segment> segments = filter::schedule(
      present, wanted,
      {.directions = settings.directions, .segment = has_segments ? kFrames : 0, .warmup = has_segments});
  const auto run = [&](const filter::Step& step) {
    filter::FrameReport report;
    filter.run(step, frame, report);
  };
  run({.frame = 0, .new_history = true, .wanted = false});  // pipelines are made in the first run
  const auto start = std::chrono::steady_clock::now();
  for (const filter::Segment& segment : segments) std::ranges::for_each(segment, run);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / kFrames;
}

}  // namespace

std::vector<PresetTime> measure_presets(const FilterOptions& options, const Frame& frame, double pixels) {
  const Frame part = centre_of(frame);
  const double scale = pixels / (static_cast<double>(part.width()) * part.height());
  gpu::Device device(device_options(options));
  // relMSE over that of `final`, geometric means over 24 held-out shots of scripts/train, of 1 to 32 samples.
  std::vector<PresetTime> presets{
      {.name = "draft", .error = 1.26}, {.name = "balanced", .error = 1.04}, {.name = "final", .error = 1.0}};
  for (PresetTime& preset : presets) {
    preset.seconds = scale * seconds_per_frame(device, resolve_settings(preset.name, options),
                                               MemoryLimit(options).bytes_of(device), part);
  }
  return presets;
}

const PresetTime& choose_preset(const std::vector<PresetTime>& presets, double seconds) {
  const auto fits =
      std::find_if(presets.rbegin(), presets.rend(), [&](const auto& p) { return p.seconds <= seconds; });
  return fits != presets.rend() ? *fits : presets.front();
}

RenderChoice choose_preset_and_samples(const std::vector<PresetTime>& presets, double seconds,
                                       double seconds_per_spp) {
  const auto error = [](const RenderChoice& choice) {
    return choice.preset.error * std::pow(choice.spp, -tracer::kFilteredErrorDecay);
  };
  const auto samples = [&](const PresetTime& preset) {
    const double spp = std::floor((seconds - preset.seconds) / seconds_per_spp);
    return static_cast<int>(std::clamp<double>(spp, 0.0, tracer::kMostSamples));
  };
  RenderChoice best{presets.front(), std::max(1, samples(presets.front()))};
  for (const PresetTime& preset : presets) {
    const RenderChoice choice{preset, samples(preset)};
    if (choice.spp > 0 && error(choice) < error(best)) best = choice;
  }
  return best;
}

}  // namespace becalm::app
