#include "app/sequence_arguments.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <limits>
#include <set>
#include <span>
#include <string_view>

#include "app/help.h"
#include "app/number_checks.h"

namespace becalm::app {
namespace {

/// What is read.
void add_input_options(CLI::App& parser, SequenceCommand& command) {
  parser
      .add_option(
          "input", command.inputs,
          "The EXR files, such as 'in/shot.####.exr', or one file; or two of halves of the samples, such "
          "as shot.b0.####.exr and shot.b1.####.exr, of which the second is found beside the first")
      ->required()
      ->expected(1, 2)
      ->option_text("INPUT [OTHER_HALF]");
  parser
      .add_flag_callback(
          "--no-halves", [&command] { command.finds_halves = false; },
          "A sequence that is named as the other half of the input is none")
      ->group(more("Input"));
  parser
      .add_option("--frame", command.frame,
                  "The frame number of a single file (default: the one in its name, or 1)")
      ->check(whole_number_from(std::numeric_limits<int>::min(), std::numeric_limits<int>::max()))
      ->option_text("N")
      ->group(more("Input"));
  parser
      .add_option(
          "--missing", command.missing,
          "A frame of --frames that is not there, or (but for error) not whole: error stops before the first "
          "frame, skip writes nothing for it, hold writes the result of the frame before it again (default: "
          "error)")
      ->check(CLI::IsMember({"error", "skip", "hold"}))
      ->option_text("error|skip|hold")
      ->group("Input");
}

/// How the result's pixels are stored.
void add_pixel_options(CLI::App& parser, SequenceCommand& command, const std::string& result) {
  parser
      .add_option(
          "--type", command.type,
          fmt::format("Type of the {} channels, not of alpha that is passed on (default: keep, that of "
                      "the input)",
                      result))
      ->check(CLI::IsMember({"half", "float", "keep"}))
      ->option_text("half|float|keep")
      ->group(more("Output"));
  const std::span<const std::string_view> names = io::compression_names();
  std::set<std::string> compressions(names.begin(), names.end());
  compressions.insert("keep");
  parser
      .add_option(
          "--compression", command.compression,
          fmt::format(
              "Compression of the part that holds them: {} or keep, the input's; ZIP instead of a lossy one "
              "that would alter channels passed on (default: keep)",
              fmt::join(names, ", ")))
      ->check(CLI::IsMember(compressions))
      ->option_text("NAME")
      ->group(more("Output"));
}

/// Which channels are written.
void add_selection_options(CLI::App& parser, SequenceCommand& command, const std::string& result) {
  CLI::Option* const only =
      parser
          .add_option(
              "--only", command.only,
              fmt::format("Leave out every channel but those of the beauty, or all that are {}", result))
          ->check(CLI::IsMember({"beauty", "denoised"}))
          ->option_text("beauty|denoised")
          ->group(more("Output"));
  parser
      .add_option("--channels", command.channels,
                  "Leave out every channel but these: channels, layers, parts, PART/LAYER, or beauty, joined "
                  "by commas")
      ->delimiter(',')
      ->excludes(only)
      ->option_text("NAME,...")
      ->group(more("Output"));
}

}  // namespace

void add_sequence_options(CLI::App& parser, SequenceCommand& command, const std::string& result) {
  command.name = parser.get_name();
  add_input_options(parser, command);
  add_layer_options(parser, command.layers);
  add_output_options(parser, command.output, "all on disk");
  add_pixel_options(parser, command, result);
  add_selection_options(parser, command, result);
  parser
      .add_flag("--dry-run", command.dry_run,
                "Check everything, print what would be read, as what, and written, and write nothing")
      ->group("Output");
  parser
      .add_flag("--strict", command.strict,
                "Audit some frames first, as info --audit does; what is found is an error (status 3)")
      ->group(more("Input"));
}

io::DenoisedFormat format_of(const SequenceCommand& command, bool keeps_alpha) {
  io::DenoisedFormat format;
  format.keeps_alpha = keeps_alpha;
  if (command.type != "keep") {
    format.type = command.type == "half" ? io::PixelType::half : io::PixelType::float32;
  }
  if (command.compression != "keep") format.compression = command.compression;
  format.channels.names = command.channels;
  format.scale = command.scale;
  if (command.only == "beauty") format.channels.names = {"beauty"};
  format.channels.denoised = command.only == "denoised";
  return format;
}

std::string describe_output(const SequenceCommand& command) {
  std::string text;
  if (!command.finds_halves) text += " halves=no";
  if (!command.stereo_camera.empty()) text += " stereo_camera=" + command.stereo_camera;
  if (command.jitter != "auto") text += " jitter=" + command.jitter;
  if (!command.scale.is_one()) {
    text += fmt::format(" scale={}/{}", command.scale.numerator, command.scale.denominator);
  }
  if (!command.checkerboard.empty()) text += " checkerboard=" + command.checkerboard;
  if (command.type != "keep") text += " type=" + command.type;
  if (command.compression != "keep") text += " compression=" + command.compression;
  if (!command.only.empty()) text += " only=" + command.only;
  if (!command.channels.empty()) text += fmt::format(" channels={}", fmt::join(command.channels, ","));
  return text;
}

}  // namespace becalm::app
