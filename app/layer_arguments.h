#pragma once

#include <string>

#include "frame/io/layers.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's
class App;
}  // namespace CLI

namespace becalm::app {

/// What commands are told about the layers of files.
struct LayerArguments {
  std::string layers;
  std::string motion;
  std::string additive = "auto";
};
void add_layer_options(CLI::App& command, LayerArguments& arguments);
/// --additive, for commands that denoise.
void add_additive_option(CLI::App& command, LayerArguments& arguments);

/// Throws Error(usage). Leaves `additive` empty: io::choose_additive needs the layers of a file for it.
io::LayerOptions layer_options(const LayerArguments& arguments);
/// As files record them, each after a space; empty where nothing was said.
std::string describe(const LayerArguments& arguments);

}  // namespace becalm::app
