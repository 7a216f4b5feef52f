// becalm info: what a scene requires, what a file or sequence holds, which devices there are.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/command.h"
#include "app/layer_arguments.h"
#include "app/mebibytes.h"
#include "filter/gpu/device.h"
#include "frame/io/additive_layers.h"
#include "frame/io/exr.h"
#include "frame/io/sequence.h"
#include "tracer/scene/load.h"

namespace becalm::app {
namespace {

struct InfoCommand {
  std::string subject;
  LayerArguments layers;
};

void print_lines(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) fmt::print("{}\n", line);
}

void describe_devices() {
  const gpu::Device chosen;  // says what to install where there is none
  for (const gpu::DeviceInfo& device : gpu::list_devices()) {
    fmt::print("{}: {} ({}, {}), {:.0f} MiB memory, storage buffers up to {:.0f} MiB{}\n", device.index,
               device.name, device.type, device.driver, mebibytes(device.memory_bytes),
               mebibytes(device.max_storage_buffer_bytes),
               device.index == chosen.info().index ? "; taken unless --device says otherwise" : "");
  }
}

void describe_file(const std::string& path, const io::LayerOptions& layers) {
  print_lines(io::describe_exr(path, layers));
  std::vector<io::AdditiveSet> sets;
  try {
    sets = io::find_additive_sets(path, layers);
  } catch (const Error&) {
    return;  // without colour nothing adds up to it, and damaged pixels are not the header's business
  }
  print_lines(io::describe(sets));
}

void describe_sequence(const io::SequencePattern& pattern, const io::LayerOptions& layers) {
  const std::vector<int> frames = pattern.frames_on_disk();
  if (frames.empty()) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: no frame of this sequence is on disk", pattern.text()));
  }
  fmt::print("{}: {} frames, {}\n", pattern.text(), frames.size(), io::format_frame_range(frames));
  describe_file(pattern.path(frames.front()), layers);
}

ExitStatus describe(const InfoCommand& command) {
  const io::LayerOptions layers = layer_options(command.layers);
  if (command.subject == "device") {
    describe_devices();
  } else if (std::filesystem::path(command.subject).extension() == ".json") {
    tracer::Scene scene = tracer::load_scene(command.subject);
    print_lines(tracer::describe_scene(scene));
  } else if (const io::SequencePattern pattern(command.subject); pattern.has_frame_field()) {
    describe_sequence(pattern, layers);
  } else {
    describe_file(command.subject, layers);
  }
  return ExitStatus::done;
}

}  // namespace

Command add_info(CLI::App& becalm) {
  CLI::App& parser =
      *becalm.add_subcommand("info", "Describe a scene, an EXR file or sequence, or the devices");
  auto command = std::make_shared<InfoCommand>();
  parser.add_option("subject", command->subject, "A scene, an EXR file or pattern, or the word device")
      ->required()
      ->option_text("SCENE.json|EXR|device");
  add_layer_options(parser, command->layers);
  parser.footer(
      "Examples:\n"
      "  becalm info room.json\n"
      "  becalm info 'out/room.####.exr'\n"
      "  becalm info device\n");
  return {&parser, [command] { return describe(*command); }};
}

}  // namespace becalm::app
