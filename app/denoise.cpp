// becalm denoise: a sequence of EXR files from any renderer, denoised into another.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "app/cancel.h"
#include "app/command.h"
#include "app/denoise_arguments.h"
#include "app/duration.h"
#include "app/eye_names.h"
#include "app/given_stereo.h"
#include "app/preset_choice.h"
#include "app/sequence_job.h"

namespace becalm::app {
namespace {

/// --time: the preset of the outputs that --resume finds, else the most accurate that takes at most so long
/// on the first frame.
void choose_by_time(SequenceCommand& command) {
  const double seconds = duration_of("--time", command.time);
  const SequenceJob job(command, denoiser(command.preset, command.filter));
  if (command.output.resume && !job.recorded_preset().empty()) {
    command.preset = job.recorded_preset();
    command.choice = fmt::format("{}, as in the frames that are there", command.preset);
    return;
  }
  const io::LoadedFrame first = job.first_frame();
  const double pixels = static_cast<double>(first.frame.width()) * first.frame.height() *
                        static_cast<double>(1 + first.other_views.size() + (first.other_eye ? 1 : 0));
  const std::vector<PresetTime> presets = measure_presets(command.filter, first.frame, pixels);
  const PresetTime& chosen = choose_preset(presets, seconds);
  command.preset = chosen.name;
  command.choice = fmt::format("{}: about {:.2g} s a frame{}", chosen.name, chosen.seconds,
                               chosen.seconds > seconds ? ", and no preset takes less" : "");
}

/// Two inputs are eyes with --stereo, or where the one that is named has a field for the eye.
void find_eyes(SequenceCommand& command) {
  if (command.inputs.size() == 1 && has_eye_field(command.inputs.front())) {
    if (command.filter.stereo == false) {
      throw Error(ExitStatus::usage, fmt::format("--no-stereo: filter the eyes of {} one after the other",
                                                 command.inputs.front()));
    }
    const std::string pattern = command.inputs.front();
    command.inputs = {pattern_of_eye(pattern, 0), pattern_of_eye(pattern, 1)};
    command.eyes = true;
  } else {
    command.eyes = command.inputs.size() == 2 && command.filter.stereo == true;
  }
  if (command.eyes) command.filter.stereo = true;
}

}  // namespace

Command add_denoise(CLI::App& becalm) {
  CLI::App& parser = *becalm.add_subcommand("denoise", "Denoise a sequence of EXR files of any renderer");
  auto command = std::make_shared<SequenceCommand>();
  add_denoise_options(parser, *command);
  return {&parser, [command] {
            apply(command->running, command->filter);
            find_eyes(*command);
            if (!command->stereo_camera.empty())
              given_stereo(command->stereo_camera);  // throws if it is none
            catch_signals();
            command->filter.additive = command->layers.additive;
            if (!command->time.empty()) choose_by_time(*command);
            return SequenceJob(*command, denoiser(command->preset, command->filter)).run();
          }};
}

}  // namespace becalm::app
