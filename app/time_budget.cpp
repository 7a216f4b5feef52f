#include "app/time_budget.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <string>
#include <vector>

#include "app/adaptive_sampling.h"
#include "app/counted.h"
#include "app/duration.h"
#include "app/eye_names.h"
#include "app/outputs.h"
#include "app/preset_choice.h"
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

}  // namespace

void choose_by_time(RenderCommand& command, tracer::Scene& scene) {
  const double seconds = duration_of("--time-budget", command.time_budget);
  const Size size = size_of(command, scene.description());
  const std::vector<int> frames = frames_of(command, scene.description());
  const bool chooses_preset = command.preset == kAutoPreset;
  const std::vector<Eye> eyes = eyes_of(command, scene.description());
  command.adaptive = true;
  if (command.output.resume) {
    const std::size_t eye = eyes.front() == Eye::right ? 1 : 0;
    const Outputs outputs("-o", {io::SequencePattern(pattern_of_eye(command.output.pattern, eye))}, frames);
    const std::string spp = setting_value(outputs.recorded("becalm:settings"), "spp");
    if (!spp.empty()) {
      command.asked_spp = recorded_spp(command.output.pattern, spp);
      if (chooses_preset) command.preset = outputs.recorded("becalm:preset");
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
