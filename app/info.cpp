// becalm info: what a scene requires, what a file or sequence holds, which devices there are.

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/additive_choice.h"
#include "app/alpha_report.h"
#include "app/audit_run.h"
#include "app/command.h"
#include "app/console.h"
#include "app/counted.h"
#include "app/eye_names.h"
#include "app/file_origin.h"
#include "app/filter_stage.h"
#include "app/folder_input.h"
#include "app/frame_problems.h"
#include "app/half_buffers.h"
#include "app/input_check.h"
#include "app/input_frames.h"
#include "app/layer_arguments.h"
#include "app/noisy_image.h"
#include "app/options.h"
#include "app/sequence_arguments.h"
#include "filter/gpu/device.h"
#include "filter/merge/additive.h"
#include "frame/io/additive_layers.h"
#include "frame/io/exr.h"
#include "frame/io/frame_range.h"
#include "frame/io/sequence.h"
#include "frame/mebibytes.h"
#include "tracer/describe_scene.h"
#include "tracer/scene/load/load.h"

namespace becalm::app {
namespace {

struct InfoCommand {
  std::string subject;
  LayerArguments layers;
  bool json = false;
  bool audit = false;
};

void print_lines(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) fmt::print("{}\n", line);
}

using Json = nlohmann::ordered_json;

void print_json(const Json& json) {
  fmt::print("{}\n", json.dump(2, ' ', /*ensure_ascii=*/false, nlohmann::json::error_handler_t::replace));
}

Json to_json(const Imath::Box2i& window) {
  return {{"x", window.min.x},
          {"y", window.min.y},
          {"width", window.max.x - window.min.x + 1},
          {"height", window.max.y - window.min.y + 1}};
}

Json to_json(const std::vector<io::ExrDescription::Part>& parts) {
  Json json = Json::array();
  for (const io::ExrDescription::Part& part : parts) {
    Json channels = Json::array();
    for (const io::ExrDescription::Channel& channel : part.channels) {
      channels.push_back({{"name", channel.name}, {"type", channel.type}, {"use", channel.use}});
    }
    json.push_back({{"name", part.name},
                    {"storage", part.storage},
                    {"compression", part.compression},
                    {"data_window", to_json(part.data_window)},
                    {"display_window", to_json(part.display_window)},
                    {"channels", std::move(channels)}});
  }
  return json;
}

void describe_devices(bool json) {
  const gpu::Device chosen;  // says what to install where there is none
  Json devices = Json::array();
  for (const gpu::DeviceInfo& device : gpu::list_devices()) {
    const bool taken = device.index == chosen.info().index;
    devices.push_back({{"index", device.index},
                       {"name", device.name},
                       {"type", device.type},
                       {"driver", device.driver},
                       {"memory_bytes", device.memory_bytes},
                       {"max_storage_buffer_bytes", device.max_storage_buffer_bytes},
                       {"taken_by_default", taken}});
    if (json) continue;
    fmt::print("{}: {} ({}, {}), {:.0f} MiB memory, storage buffers up to {:.0f} MiB{}\n", device.index,
               device.name, device.type, device.driver, mebibytes(device.memory_bytes),
               mebibytes(device.max_storage_buffer_bytes),
               taken ? "; taken unless --device says otherwise" : "");
  }
  if (json) print_json(devices);
}

void describe_scene(const std::string& path, bool json) {
  tracer::Scene scene = tracer::load_scene(path);
  warn_each(scene.description().warnings);
  const std::vector<std::string> lines = tracer::describe_scene(scene);
  json ? print_json({{"scene", path}, {"lines", lines}}) : print_lines(lines);
}

/// What becalm denoise takes of frames, unless told otherwise.
AovSet taken_by_default() {
  return denoiser(SequenceCommand().preset, {}).wanted | filter::additive_aovs();
}

/// The options with the layers that are denoised with the beauty.
io::LayerOptions with(const AdditiveChoice& choice, io::LayerOptions layers) {
  layers.additive = choice.layers;
  return layers;
}

Json to_json(const std::vector<io::AdditiveSet>& sets) {
  Json json = Json::array();
  for (const io::AdditiveSet& set : sets) {
    json.push_back({{"layers", set.layers},
                    {"adds_up", set.adds_up()},
                    {"share_off", set.share_off},
                    {"cropped", set.cropped}});
  }
  return json;
}

/// --audit: what would spoil the result of denoising these frames.
std::vector<FrameFinding> audit_of(const io::SequencePattern& pattern, const std::vector<int>& frames,
                                   const io::LayerOptions& layers) {
  const std::optional<io::SequencePattern> other_half = find_other_half(pattern);
  std::vector<std::string> paths;
  for (const int frame : frames) {
    paths.push_back(pattern.path(frame));
    if (other_half) paths.push_back(other_half->path(frame));
  }
  std::optional<Imath::Box2i> window;  // as denoise sees them; each frame's own where it would refuse them
  try {
    window = find_window(paths, layers).window;
  } catch (const Error& error) {
    if (error.status() != ExitStatus::bad_input) throw;
  }
  const auto read = [&](const std::string& path, int frame) {
    return io::read_exr(path, frame, AovSet().set(), layers, io::LightGroups::leave, window);
  };
  return audit_frames(frames, [&](int frame) {
    io::LoadedFrame loaded = read(pattern.path(frame), frame);
    if (other_half) {
      const std::string path = other_half->path(frame);
      join_halves(loaded, read(path, frame), path);
    }
    return loaded;
  });
}

void print_audit(const std::vector<FrameFinding>& findings) {
  if (findings.empty()) fmt::print("audit: nothing found that would spoil the result\n");
  for (const FrameFinding& finding : findings) fmt::print("audit: {}\n", finding.text());
}

Json to_json(const std::vector<FrameFinding>& findings) {
  Json json = Json::array();
  for (const FrameFinding& finding : findings) {
    json.push_back({{"frame", finding.frame},
                    {"view", finding.view},
                    {"check", finding.finding.check},
                    {"text", finding.finding.text}});
  }
  return json;
}

void describe_file(const InfoCommand& command, io::LayerOptions layers) {
  const std::string& path = command.subject;
  const io::SequencePattern pattern(path);
  const std::vector<int> frames{io::number_in_name(path)};
  const std::optional<NoisyImage> noisy = take_noisy_image({{frames.front(), path}}, layers);
  const AdditiveChoice additive = choose_additive("auto", {{frames.front(), path}}, layers);
  const io::ExrDescription file = io::describe_exr(path, with(additive, layers), taken_by_default());
  const std::string alpha = alpha_outlook(path, layers);
  std::vector<FrameFinding> findings;
  const bool audits = command.audit && file.problem.empty();
  if (audits) findings = audit_of(pattern, frames, layers);
  if (command.json) {
    Json json{{"file", path},
              {"parts", to_json(file.parts)},
              {"checkerboard", file.is_checkerboard},
              {"additive", to_json(additive.sets)},
              {"alpha", alpha},
              {"becalm", origin_of(path)},
              {"problem", file.problem}};
    if (audits) json["audit"] = to_json(findings);
    print_json(json);
  } else {
    fmt::print("{}: EXR with {}\n", path, counted(file.parts.size(), "part", "parts"));
    print_lines(file.lines());
    if (noisy) fmt::print("{}\n", noisy->text());
    for (const AdditiveNote& note : additive.notes) fmt::print("{}\n", note.text);
    if (!alpha.empty()) fmt::print("{}\n", alpha);
    print_lines(origin_lines(origin_of(path)));
    if (audits) print_audit(findings);
  }
  if (!file.problem.empty()) throw Error(ExitStatus::bad_input, file.problem);
}

/// One frame of a sequence.
struct Described {
  int frame = 0;
  io::ExrDescription file;
  Json origin = Json::object();    ///< as origin_of has it
  std::vector<std::string> lines;  ///< of both
  std::string problem;
};

/// Frames of equal description.
struct Kind {
  const Described* first;
  std::vector<int> frames;
};

std::vector<Described> describe_frames(const io::SequencePattern& pattern, const std::vector<int>& frames,
                                       const io::LayerOptions& layers) {
  const AovSet taken = taken_by_default();
  std::vector<Described> described(frames.size());
  tbb::parallel_for(std::size_t{0}, frames.size(), [&](std::size_t i) {
    described[i].frame = frames[i];
    try {
      described[i].file = io::describe_exr(pattern.path(frames[i]), layers, taken);
      described[i].origin = origin_of(pattern.path(frames[i]));
      described[i].lines = described[i].file.lines();
      std::ranges::copy(origin_lines(described[i].origin), std::back_inserter(described[i].lines));
      described[i].problem = described[i].file.problem;
    } catch (const Error& error) {
      if (error.status() == ExitStatus::resource) throw;  // no fault of the frame
      described[i].problem = error.what();
    }
  });
  return described;
}

/// The line with one blank for each run of them: columns are as wide as a file's longest channel name.
std::string without_columns(std::string line) {
  const auto both_blank = [](char a, char b) { return a == ' ' && b == ' '; };
  line.erase(std::unique(line.begin(), line.end(), both_blank), line.end());
  return line;
}

/// The lines of `usual` that `kind` lacks, and those of `kind` that `usual` lacks.
void print_difference(const Kind& kind, const Kind& usual) {
  const auto print_missing = [](const Kind& from, const Kind& in, char sign) {
    for (const std::string& line : from.first->lines) {
      const auto same = std::ranges::find(in.first->lines, without_columns(line), without_columns);
      if (same == in.first->lines.end()) fmt::print("{} {}\n", sign, line);
    }
  };
  print_missing(usual, kind, '-');
  print_missing(kind, usual, '+');
}

/// Frames of equal description together, the most common first.
std::vector<Kind> kinds_of(const std::vector<Described>& described) {
  std::vector<Kind> kinds;
  for (const Described& frame : described) {
    if (frame.lines.empty()) continue;
    auto kind = std::ranges::find_if(kinds, [&](const Kind& k) { return k.first->lines == frame.lines; });
    if (kind == kinds.end()) kind = kinds.insert(kind, {&frame, {}});
    kind->frames.push_back(frame.frame);
  }
  std::ranges::stable_sort(kinds, std::ranges::greater(),
                           [](const Kind& kind) { return kind.frames.size(); });
  return kinds;
}

/// The distance of the frames of a shot: 2 on twos. Files that were denoised while rendering tell which
/// frames were rendered for them.
int step_of_shot(const io::SequencePattern& pattern, const std::vector<int>& frames,
                 const std::vector<Described>& described) {
  if (described.back().origin.empty()) return usual_step(frames);
  try {
    const std::string made_from = io::read_attribute(pattern.path(frames.back()), "becalm:made_from");
    return usual_step(io::parse_frame_range(made_from));
  } catch (const Error&) {  // most files have no such text
    return usual_step(frames);
  }
}

void print_kinds(const std::vector<Kind>& kinds, int step) {
  constexpr std::size_t most_kinds = 10;  // data windows may differ in every frame
  for (std::size_t i = 0; i < std::min(kinds.size(), most_kinds); ++i) {
    if (kinds.size() > 1) {
      fmt::print("frames {}{}:\n", io::format_frame_range(kinds[i].frames, step),
                 i == 0 ? "" : " have instead");
    }
    i == 0 ? print_lines(kinds[i].first->lines) : print_difference(kinds[i], kinds[0]);
  }
  if (kinds.size() > most_kinds) fmt::print("{} more kinds of frames\n", kinds.size() - most_kinds);
}

Json to_json(const std::vector<Kind>& kinds, int step) {
  Json json = Json::array();
  for (const Kind& kind : kinds) {
    json.push_back({{"frames", io::format_frame_range(kind.frames, step)},
                    {"parts", to_json(kind.first->file.parts)},
                    {"checkerboard", kind.first->file.is_checkerboard},
                    {"becalm", kind.first->origin}});
  }
  return json;
}

/// The description that most frames have, how becalm made them, and how others differ from it; the additive
/// layers; of the first frame, what becomes of alpha.
void describe_sequence(const io::SequencePattern& pattern, io::LayerOptions layers,
                       const InfoCommand& command) {
  const std::vector<int> frames = pattern.frames_on_disk();
  pattern.refuse_wider_numbers();
  if (frames.empty()) {
    throw Error(ExitStatus::bad_input, fmt::format("{}: no frame of this sequence is on disk{}",
                                                   pattern.text(), pattern.hint_where_missing()));
  }
  std::vector<NumberedFile> files = files_on_disk(pattern);
  if (const auto other = find_other_half(pattern))
    std::ranges::move(files_on_disk(*other), std::back_inserter(files));
  const std::optional<NoisyImage> noisy = take_noisy_image(files, layers);
  const AdditiveChoice additive = choose_additive("auto", files, layers);
  const std::vector<Described> described = describe_frames(pattern, frames, with(additive, layers));
  const std::vector<Kind> kinds = kinds_of(described);
  const int step = step_of_shot(pattern, frames, described);
  FrameProblems problems(pattern, step);
  const std::string alpha = alpha_outlook(pattern.path(frames.front()), layers);
  Json problems_json = Json::array();
  for (const Described& frame : described) {
    if (frame.problem.empty()) continue;
    problems.add(frame.frame, frame.problem);
    problems_json.push_back({{"frame", frame.frame}, {"problem", frame.problem}});
  }
  std::vector<FrameFinding> findings;
  const bool audits = command.audit && problems.empty();
  if (audits) findings = audit_of(pattern, frames, layers);
  if (command.json) {
    Json json{{"pattern", pattern.text()},
              {"frames", io::format_frame_range(frames, step)},
              {"kinds", to_json(kinds, step)},
              {"additive", to_json(additive.sets)},
              {"alpha", alpha},
              {"becalm", described.front().origin},
              {"problems", std::move(problems_json)}};
    if (audits) json["audit"] = to_json(findings);
    print_json(json);
  } else {
    fmt::print("{}: {}, {}\n", pattern.text(), counted(frames.size(), "frame", "frames"),
               io::format_frame_range(frames, step));
    if (const auto other = find_other_half(pattern)) {
      fmt::print("{} is the other half of the samples; denoise takes the mean of both\n", other->text());
    }
    print_kinds(kinds, step);
    if (noisy) fmt::print("{}\n", noisy->text());
    for (const AdditiveNote& note : additive.notes) fmt::print("{}\n", note.text);
    if (!alpha.empty()) fmt::print("{}\n", alpha);
    if (audits) print_audit(findings);
    if (command.audit && !audits) fmt::print("audit: not done, since frames cannot be denoised\n");
  }
  if (!problems.empty()) problems.fail(frames.size(), "");
}

void describe_subject(const InfoCommand& command) {
  const io::LayerOptions layers = layer_options(command.layers);
  const bool is_scene = std::filesystem::path(command.subject).extension() == ".json";
  if (command.audit && (is_scene || command.subject == "device")) {
    throw Error(ExitStatus::usage, fmt::format("--audit looks at EXR files, and {} is {}", command.subject,
                                               is_scene ? "a scene" : "none"));
  }
  if (command.subject == "device") {
    describe_devices(command.json);
    return;
  }
  refuse_folder(command.subject);
  if (is_scene) {
    describe_scene(command.subject, command.json);
  } else if (const io::SequencePattern pattern(command.subject); pattern.has_frame_field()) {
    describe_sequence(pattern, layers, command);
  } else {
    describe_file(command, layers);
  }
}

ExitStatus describe(const InfoCommand& command) {
  if (command.json) refuse_eye_field(command.subject);  // it is one object
  const std::size_t eyes = has_eye_field(command.subject) ? kEyeNames.size() : 1;
  for (std::size_t eye = 0; eye < eyes; ++eye) {
    InfoCommand of_eye = command;
    of_eye.subject = pattern_of_eye(command.subject, eye);
    describe_subject(of_eye);
  }
  return ExitStatus::done;
}

}  // namespace

Command add_info(CLI::App& becalm) {
  CLI::App& parser =
      *becalm.add_subcommand("info", "Describe a scene, an EXR file or sequence, or the devices");
  auto command = std::make_shared<InfoCommand>();
  constexpr const char* subject = "SCENE.json|EXR|device";
  parser.add_option(subject, command->subject, "A scene, an EXR file or pattern, or the word device")
      ->required()
      ->option_text(subject);
  add_layer_options(parser, command->layers);
  parser.add_flag(
      "--audit", command->audit,
      "Look at the pixels of some frames for what would spoil a denoised result: noise that repeats, "
      "guides that mislead, clamped light and more");
  parser.add_flag("--json", command->json, "Print one JSON object, for scripts");
  parser.footer(
      "Examples:\n"
      "  becalm info room.json\n"
      "  becalm info 'out/room.####.exr'\n"
      "  becalm info device\n");
  return {&parser, [command] { return describe(*command); }};
}

}  // namespace becalm::app
