#include "app/denoise_arguments.h"

#include <CLI/CLI.hpp>

#include "app/help.h"

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
  parser
      .add_flag_callback(
          "--stereo", [&command] { command.filter.stereo = true; },
          "The two inputs are the left and the right eye, which are filtered together; the same is meant by "
          "one "
          "input with %V (left, right) or %v (l, r), and without this option by the views left and right of "
          "one file")
      ->group(more("Input"));
  parser
      .add_flag_callback(
          "--no-stereo", [&command] { command.filter.stereo = false; },
          "The views of a file are filtered each by itself")
      ->excludes("--stereo")
      ->group(more("Input"));
  parser
      .add_option(
          "--stereo-camera", command.stereo_camera,
          "The cameras of eyes whose files do not say them (becalm's do): focal length in pixels, "
          "separation and distance of convergence in the depth's units, and ,planar where depths are along "
          "the view; without, the eyes are searched for each other")
      ->option_text("F,S,C[,planar]")
      ->group(more("Input"));
  add_additive_option(parser, command.layers);
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
      "  becalm denoise 'in/shot.####.exr' -o 'out/shot.####.exr' --frames 1-48 --preset final --missing "
      "hold\n"
      "  becalm denoise 'in/shot.%V.####.exr' -o 'out/shot.%V.####.exr'   # both eyes\n");
}

}  // namespace becalm::app
