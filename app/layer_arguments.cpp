#include "app/layer_arguments.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "app/help.h"

namespace becalm::app {

void add_layer_options(CLI::App& command, LayerArguments& arguments) {
  command
      .add_option(
          "--layers", arguments.layers,
          "Layers to read where the names are not known, such as albedo=diffcol,normal=PART/N, or none "
          "to leave one out; becalm info tells which are taken")
      ->option_text("AOV=NAME,...")
      ->group("Input");
  command
      .add_option("--motion", arguments.motion,
                  "Where motion vectors count another way than becalm info says: some of flip-x, flip-y, "
                  "scale=S, swap (X and Y), joined by commas")
      ->option_text("CHANGE,...")
      ->group(more("Input"));
}

void add_additive_option(CLI::App& command, LayerArguments& arguments) {
  command
      .add_option(
          "--additive", arguments.additive,
          "Layers that are denoised with the beauty so that they still add up to it: auto takes those "
          "whose names say so and whose sum is the beauty; auto,NAME takes others, too, and NAME these alone "
          "(default: auto)")
      ->option_text("auto|NAME,...|none")
      ->group(more("Input"));
}

io::LayerOptions layer_options(const LayerArguments& arguments) {
  return {.layers = io::parse_layer_overrides(arguments.layers),
          .motion = io::parse_motion_change(arguments.motion)};
}

std::string describe(const LayerArguments& arguments) {
  std::string text;
  const auto add = [&](const char* key, std::string value) {
    std::ranges::replace(value, ' ', '_');  // a blank ends a value
    text += fmt::format(" {}={}", key, value);
  };
  if (!arguments.layers.empty()) add("layers", arguments.layers);
  if (!arguments.motion.empty())
    add("motion_change", arguments.motion);  // `motion` is a setting of the filter
  if (arguments.additive != "auto") add("additive_layers", arguments.additive);
  return text;
}

}  // namespace becalm::app
