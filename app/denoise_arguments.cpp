#include "app/denoise_arguments.h"

#include <CLI/CLI.hpp>

namespace becalm::app {

void add_denoise_options(CLI::App& parser, SequenceCommand& command) {
  add_sequence_options(parser, command, "denoised");
  CLI::Option* const preset =
      parser
          .add_option(
              "--preset", command.preset,
              "draft, balanced or final: speed against accuracy (default: balanced); paper: as published")
          ->option_text("NAME")
          ->group("Filter");
  parser
      .add_option("--time", command.time, "The most accurate preset that takes at most so long a frame: 2s")
      ->excludes(preset)
      ->option_text("TIME")
      ->group("Filter");
  add_alpha_option(parser, command.filter);
  add_filter_options(parser, command.filter);
  add_running_options(parser, command.running);
  parser.add_flag_callback(
      "--help-settings", [] { throw CLI::CallForVersion(denoise_settings_help(), 0); },
      "Print what --set takes and what the presets have, and exit");
  parser.footer(
      "Direct and indirect light, light groups (light.NAME) and layers that add up to the beauty are\n"
      "denoised with it and still add up. Every other channel is passed on bit for bit.\n"
      "Examples:\n"
      "  becalm denoise 'in/shot.####.exr' -o 'out/shot.####.exr'\n"
      "  becalm denoise 'in/shot.####.exr' -o 'out/shot.####.exr' --frames 1-48 --preset final --missing "
      "hold\n");
}

}  // namespace becalm::app
