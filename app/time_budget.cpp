#include "app/time_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "app/adaptive_sampling.h"
#include "app/counted.h"
#include "app/duration.h"
#include "app/eye_names.h"
#include "app/outputs.h"
#include "app/preset_choice.h"
#include "app/scratch_files.h"
#include "app/setting_text.h"
#include "frame/error.h"

namespace becalm::app {

namespace {

int recorded_spp(const std::string& pattern, const std::string& text) {
  int spp = 0;
  const char* end = text.data() + text.size();
  const auto [parsed_to, error] = std::from_chars(text.data(), end, spp);
  if (error == std::errc() && parsed_to == end && spp > 0) return spp;
  throw Error(ExitStatus::bad_input,
              fmt::format("{}: becalm:settings: spp={}, expected a number of samples", pattern, text));
}

/// What an earlier run has recorded in its files; empty where there are none.
struct Recorded {
  std::string spp;
  std::string preset;
};

Recorded recorded_in(const Outputs& outputs) {
  return {setting_value(outputs.recorded("becalm:settings"), "spp"), outputs.recorded("becalm:preset")};
}

/// Of the outputs, or if it was stopped before the first of them, of the noisy frames: of those asked for
/// first, as others may share their folder.
Recorded recorded_by_earlier_run(const RenderCommand& command, Eye first, std::vector<int> frames) {
  const std::size_t eye = first == Eye::right ? 1 : 0;
  const Recorded recorded =
      recorded_in(Outputs("-o", {io::SequencePattern(pattern_of_eye(command.output.pattern, eye))}, frames));
  if (!recorded.spp.empty()) return recorded;
  const io::SequencePattern noisy(noisy_pattern(command.keep_noisy, command.output.pattern, first, frames));
  std::ranges::copy(noisy.frames_on_disk(), std::back_inserter(frames));
  return recorded_in(Outputs("--keep-noisy", {noisy}, std::move(frames)));
}

}  // namespace

void choose_by_time(RenderCommand& command, tracer::Scene& scene) {
  const double seconds = duration_of("--time-budget", command.time_budget);
  const Size size = size_of(command, scene.description());
  const std::vector<int> frames = frames_of(command, scene.description());
  const bool chooses_preset = command.preset == kAutoPreset;
  const std::vector<Eye> eyes = eyes_of(command, scene.description());
  command.adaptive = true;
  if (command.output.resume) {
    const auto [spp, preset] = recorded_by_earlier_run(command, eyes.front(), frames);
    if (!spp.empty() && !(chooses_preset && preset.empty())) {
      command.asked_spp = recorded_spp(command.output.pattern, spp);
      if (chooses_preset) command.preset = preset;
      command.choice =
          fmt::format("{} samples per pixel and {}, as in the frames that are there", spp, command.preset);
      return;
    }
  }
  tracer::RenderOptions options = render_options(command, size);
  options.eye = eyes.front();
  AdaptiveSampling sampling(scene, options, command.filter, {});
  tracer::RenderReport report;
  std::optional<Frame> pilot;
  for (int run = 0; run < 2; ++run) {  // the first one also loads textures
    pilot = sampling.render_pilot(frames.front(), &report);
    if (!pilot) return;
  }
  const auto views = static_cast<double>(eyes.size());
  report.seconds *= views;
  const double seconds_per_spp = report.seconds / AdaptiveSampling::pilot_spp();
  std::vector<PresetTime> presets =
      measure_presets(command.filter, *pilot, views * static_cast<double>(size.width) * size.height);
  const double pilot_seconds = report.seconds + presets.front().seconds / 4.0;
  if (!chooses_preset) std::erase_if(presets, [&](const auto& p) { return p.name != command.preset; });
  if (presets.empty()) throw Error(ExitStatus::usage, "--time-budget: expected draft, balanced or final");
  const RenderChoice choice = choose_preset_and_samples(presets, seconds - pilot_seconds, seconds_per_spp);
  const double expected = pilot_seconds + choice.preset.seconds + choice.spp * seconds_per_spp;
  command.preset = choice.preset.name;
  command.asked_spp = choice.spp;
  command.choice =
      fmt::format("{} per pixel on average and {}: about {:.2g} s a frame{}",
                  counted(static_cast<std::size_t>(choice.spp), "sample", "samples"), choice.preset.name,
                  expected, expected > 1.1 * seconds ? ", and no preset takes less" : "");
}

}  // namespace becalm::app
