// becalm antialias: a sequence of EXR files of few jittered samples, averaged over time into another.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "app/cancel.h"
#include "app/command.h"
#include "app/given_jitter.h"
#include "app/help.h"
#include "app/sequence_job.h"

namespace becalm::app {
namespace {

void add_antialias_options(CLI::App& parser, SequenceCommand& command) {
  add_sequence_options(parser, command, "antialiased");
  parser
      .add_option(
          "--jitter", command.jitter,
          "Where samples lie in their pixels: auto, as becalm's files tell; none; or halton:N, for frame "
          "f the point f mod N + 1 of Halton's bases 2 and 3, less a half pixel (default: auto)")
      ->option_text("auto|none|halton:N")
      ->group("Input");
  parser
      .add_option_function<std::string>(
          "--scale", [&command](const std::string& text) { command.scale = given_scale(text); },
          "Output S times as wide and high: 1.5, 3/2, 2, up to 4. Samples of a jittered sequence lie "
          "between each other's, so that it holds more than one of its frames does (default: 1)")
      ->option_text("S")
      ->group("Output");
  parser
      .add_flag(
          "--checkerboard{auto}", command.checkerboard,
          "Frames hold every other pixel, as of becalm render --checkerboard; the output has all. Auto, as "
          "the files tell; even: those of even x + y in frames of even numbers, the others in those of "
          "odd ones; odd: the reverse")
      ->option_text("[=auto|even|odd]")
      ->group("Input");
  parser
      .add_option("--preset", command.preset,
                  "best, from the frames before and after; forward, from those before alone; to compare: "
                  "clamping, gain and paper, as published (default: best)")
      ->option_text("NAME")
      ->group("Filter");
  add_filter_options(parser, command.filter);
  add_running_options(parser, command.running);
  parser.add_flag_callback(
      "--help-settings", [] { throw CLI::CallForVersion(antialias_settings_help(), 0); },
      "Print what --set takes and what the presets have, and exit");
  parser.footer(
      "For frames of 1 to 4 samples a pixel and little noise; noisy ones need becalm denoise. Vectors are\n"
      "used where frames have them, with their depth. Every channel but the beauty is passed on bit for "
      "bit;\n"
      "with --scale or --checkerboard a pixel has the nearest sample's values, and motion is scaled.\n"
      "Examples:\n"
      "  becalm render scene.json -o 'in/shot.####.exr' --spp 1 --aovs motion,depth   # film.jitter_cycle: "
      "16\n"
      "  becalm antialias 'in/shot.####.exr' -o 'out/shot.####.exr'\n"
      "  becalm antialias 'half/shot.####.exr' -o 'out/shot.####.exr' --scale 2\n");
}

}  // namespace

Command add_antialias(CLI::App& becalm) {
  CLI::App& parser =
      *becalm.add_subcommand("antialias", "Average jittered frames over time: temporal antialiasing");
  auto command = std::make_shared<SequenceCommand>();
  command->preset = "best";
  add_antialias_options(parser, *command);
  return {
      &parser, [command] {
        apply(command->running, command->filter);
        catch_signals();
        if (command->jitter != "auto") given_jitter(command->jitter, 0);  // throws if it is none
        command->filter.additive = "none";
        if (const std::string& given = command->checkerboard;
            !given.empty() && given != "auto" && given != "even" && given != "odd") {
          throw Error(ExitStatus::usage, fmt::format("--checkerboard={}: expected auto, even or odd", given));
        }
        if (const std::string& last = command->inputs.back();
            last == "auto" || last == "even" || last == "odd")
          throw Error(ExitStatus::usage, fmt::format("{0}: expected --checkerboard={0}", last));
        const Checkerboards checkerboards = command->checkerboard.empty()     ? Checkerboards::refused
                                            : command->checkerboard == "auto" ? Checkerboards::as_files_tell
                                                                              : Checkerboards::as_told;
        return SequenceJob(*command,
                           antialiaser(command->preset, command->filter, command->scale, checkerboards))
            .run();
      }};
}

}  // namespace becalm::app
