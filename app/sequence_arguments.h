#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/layer_arguments.h"
#include "app/options.h"
#include "frame/io/exr.h"
#include "frame/scale.h"

namespace becalm::app {

/// What the user typed after `becalm denoise` or `becalm antialias`.
struct SequenceCommand {
  std::string name;
  std::vector<std::string> inputs;
  std::string stereo_camera;  ///< of eyes whose files do not say it; empty: not known
  bool eyes = false;          ///< the inputs are the left and the right eye
  bool finds_halves = true;   ///< of a single input, by its name
  OutputOptions output;
  FilterOptions filter;
  RunningOptions running;
  std::string type = "keep";
  std::string compression = "keep";
  std::string only;
  std::vector<std::string> channels;
  bool dry_run = false;
  bool strict = false;
  std::string preset = "balanced";
  std::string time;    ///< that a frame may take; empty: the preset is as named
  std::string choice;  ///< what was chosen for the time, for the user to read
  std::optional<int> frame;
  LayerArguments layers;
  std::string missing = "error";
  // For `antialias`:
  std::string jitter = "auto";  ///< of the samples
  Scale scale;
  std::string checkerboard;  ///< auto, even, odd; empty: none
};

/// The input, the layers taken from it, the output and how it is written. `result` is what the channels that
/// are filtered become, such as `denoised`.
void add_sequence_options(CLI::App& parser, SequenceCommand& command, const std::string& result);

/// How the outputs are written. `keeps_alpha` as DenoisedFormat has it.
io::DenoisedFormat format_of(const SequenceCommand& command, bool keeps_alpha);
/// What decides the bytes of an output besides the filter and the inputs, as files record it: each after a
/// space, and nothing for a default.
std::string describe_output(const SequenceCommand& command);

}  // namespace becalm::app
