// becalm denoise: a sequence of EXR files from any renderer, denoised into another.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <span>

#include "app/alpha_report.h"
#include "app/audit_run.h"
#include "app/cancel.h"
#include "app/command.h"
#include "app/console.h"
#include "app/counted.h"
#include "app/filter_run.h"
#include "app/filter_step.h"
#include "app/fingerprints.h"
#include "app/half_buffers.h"
#include "app/input_check.h"
#include "app/input_frames.h"
#include "app/layer_arguments.h"
#include "app/options.h"
#include "app/outputs.h"
#include "app/profile.h"
#include "app/progress.h"
#include "app/writing.h"
#include "filter/merge/additive.h"
#include "frame/io/additive_layers.h"
#include "frame/io/exr.h"
#include "frame/io/sequence.h"

namespace becalm::app {
namespace {

struct DenoiseCommand {
  std::vector<std::string> inputs;
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
  std::optional<int> frame;
  LayerArguments layers;
  std::string missing = "error";
};

/// Of what adds up to the beauty, layers of other parts are passed on.
void leave_other_parts(io::LoadedView& view) {
  for (const AovInfo& entry : kAovTable) {
    if (!contains(filter::additive_aovs(), entry.aov) || !view.frame.has(entry.aov)) continue;
    const auto part_of = [&](Aov aov) { return view.layers[static_cast<std::size_t>(aov)]->part; };
    if (part_of(entry.aov) != part_of(Aov::beauty)) view.frame.remove(entry.aov);
  }
}

io::DenoisedFormat format_of(const DenoiseCommand& command) {
  io::DenoisedFormat format;
  if (command.type != "keep") {
    format.type = command.type == "half" ? io::PixelType::half : io::PixelType::float32;
  }
  if (command.compression != "keep") format.compression = command.compression;
  format.channels.names = command.channels;
  if (command.only == "beauty") format.channels.names = {"beauty"};
  format.channels.denoised = command.only == "denoised";
  return format;
}

/// One run of `becalm denoise`.
class DenoiseJob {
 public:
  explicit DenoiseJob(const DenoiseCommand& command);
  ExitStatus run();

 private:
  void choose_additive();
  std::string settings() const;
  void find_existing();
  void print_plan(const std::set<int>& needed);
  io::LoadedFrame read(int frame);
  io::LoadedFrame read_pixels(int frame) const;
  io::LoadedFrame read_file(const std::string& path, int frame) const;
  void require_sound_input(const std::vector<int>& frames) const;
  std::string halves_text() const;
  void write(DenoisedFile& result);
  /// For what is the same with every frame that is written.
  void warn_once(const std::string& line);

  const DenoiseCommand& command_;
  const ThreadLimit threads_;
  io::LayerOptions layers_;
  const io::DenoisedFormat format_;
  FilterStep filter_;
  const InputFrames inputs_;
  Outputs outputs_;
  const InputWindow window_;
  Fingerprints fingerprints_;
  io::Attributes attributes_;
  std::vector<std::string> additive_notes_;
  std::set<int> existing_;
  std::set<std::string> said_;
  std::optional<Progress> progress_;
  Profile profile_;
};

DenoiseJob::DenoiseJob(const DenoiseCommand& command)
    : command_(command),
      threads_(command.running.threads),
      layers_(layer_options(command.layers)),
      format_(format_of(command)),
      filter_(command.preset, command.filter),
      inputs_(command.inputs, command.output.frames, command.frame, parse_missing(command.missing),
              [this](const auto& asked, const auto& on_disk) { return filter_.readable(asked, on_disk); }),
      outputs_("-o", inputs_.output_pattern(command.output.pattern), inputs_.outputs()),
      window_(find_window(inputs_, layers_)),
      fingerprints_(inputs_, filter_, layers_, window_) {
  std::vector<std::string> paths;
  for (const int frame : inputs_.readable())
    std::ranges::copy(inputs_.paths(frame), std::back_inserter(paths));
  outputs_.keep_apart_from(paths);
}

/// By the sequence's first frame, whichever frames this job is about.
void DenoiseJob::choose_additive() {
  if (!filter_.denoises_additive()) return;
  const io::SequencePattern& pattern = inputs_.pattern();
  const std::string path = pattern.has_frame_field() ? pattern.path(pattern.frames_on_disk().front())
                                                     : inputs_.path(inputs_.readable().front());
  std::vector<io::AdditiveSet> sets;
  if (command_.layers.additive == "auto") {
    try {
      sets = io::find_additive_sets(path, layers_);
    } catch (const Error&) {
      return;  // check_inputs tells what is wrong, if this frame is needed
    }
  }
  layers_.additive = io::choose_additive(command_.layers.additive, sets);
  additive_notes_ = io::describe(sets);
  if (!layers_.additive.empty()) {
    attributes_.emplace_back("becalm:additive", fmt::format("{}", fmt::join(layers_.additive, ",")));
  }
}

ExitStatus DenoiseJob::run() {
  attributes_ = {{"becalm:version", BECALM_VERSION},
                 {"becalm:settings", settings()},
                 {"becalm:preset", command_.preset}};
  choose_additive();

  if (!command_.output.overwrite && !command_.output.resume) outputs_.keep_foreign_files();
  if (!command_.dry_run) outputs_.prepare();
  if (command_.output.resume) find_existing();
  // Without segments every frame depends on all before it.
  const std::set<int> wanted =
      filter_.has_segments() ? inputs_.sources_of_missing(existing_) : inputs_.up_to_last_missing(existing_);
  const std::size_t asked = outputs_.frames().size();
  if (wanted.empty()) return all_there(asked, command_.running.quiet);

  progress_.emplace(ProgressOptions{.total = asked,
                                    .existing = existing_.size(),
                                    .work = wanted.size(),
                                    .quiet = command_.running.quiet,
                                    .verbose = command_.running.verbose});
  std::vector<filter::Step> steps;
  for (const filter::Segment& segment : filter_.schedule(inputs_.readable(), wanted, inputs_.step())) {
    steps.insert(steps.end(), segment.begin(), segment.end());
  }
  std::set<int> needed;
  for (const filter::Step& step : steps) needed.insert(step.frame);
  const std::vector<InputLayout> views = check_inputs(inputs_, needed, filter_, layers_);
  if (command_.strict) require_sound_input({needed.begin(), needed.end()});
  io::check_selection(inputs_.path(*needed.begin()), layers_, format_.channels, "--channels");
  if (command_.dry_run) {
    print_plan(needed);
    return ExitStatus::done;
  }
  progress_->detail(fmt::format("{}x{} px of {}", window_.width(), window_.height(),
                                fingerprints_.layers_of(*needed.begin())));
  for (const InputLayout& view : views) {
    filter_.build(window_.width(), window_.height(), view.aovs, view.light_groups.size(), view.view,
                  views.size());
  }
  if (!inputs_.note().empty()) progress_->warn(inputs_.note());
  if (inputs_.other_half()) progress_->note(halves_text());
  for (const std::string& note : additive_notes_) progress_->note(note);
  if (!inputs_.has_numbers()) {
    progress_->note(
        fmt::format("{}: no frame number in the name, so this is frame 1; --frame N says otherwise",
                    inputs_.pattern().text()));
  }
  const double work_per_step = static_cast<double>(wanted.size()) / static_cast<double>(steps.size());
  run_filter(
      filter_, steps,
      {.read = [this](int frame) { return read(frame); },
       .write = [this](DenoisedFile& result) { write(result); }},
      [&](std::size_t step) {
        progress_->update(steps[step].frame, work_per_step * static_cast<double>(step));
      },
      *progress_, profile_);
  filter_.finish(profile_);
  return conclude(*progress_, asked, command_.running.profile ? &profile_ : nullptr);
}

/// What decides the bytes of an output, besides the frames that it is made from.
std::string DenoiseJob::settings() const {
  std::string text = filter_.describe(inputs_.readable()) + app::describe(command_.layers);
  if (command_.type != "keep") text += " type=" + command_.type;
  if (command_.compression != "keep") text += " compression=" + command_.compression;
  if (!command_.only.empty()) text += " only=" + command_.only;
  if (!command_.channels.empty()) text += fmt::format(" channels={}", fmt::join(command_.channels, ","));
  return text;
}

/// --dry-run: what would be read, as what, and written, on standard output.
void DenoiseJob::print_plan(const std::set<int>& needed) {
  std::vector<int> written;
  std::ranges::set_difference(outputs_.frames(), existing_, std::back_inserter(written));
  const auto print = [](const char* verb, const std::string& pattern, const std::vector<int>& frames) {
    fmt::print("{} {}: {}, {}\n", verb, pattern, counted(frames.size(), "frame", "frames"),
               io::format_frame_range(frames));
  };
  print("reads", inputs_.pattern().text(), {needed.begin(), needed.end()});
  fmt::print(
      "takes {}x{} px of {}; {}\n", window_.width(), window_.height(),
      fingerprints_.layers_of(*needed.begin()),
      format_.channels.selects_all() ? "passes on every other channel" : "leaves channels out as told");
  if (inputs_.other_half()) fmt::print("{}\n", halves_text());
  for (const std::string& note : additive_notes_) fmt::print("{}\n", note);
  fmt::print("filters with preset {}: {}\n", command_.preset, settings());
  if (!existing_.empty()) print("keeps", command_.output.pattern, {existing_.begin(), existing_.end()});
  print("writes", command_.output.pattern, written);
}

void DenoiseJob::find_existing() {
  Outputs::Existing found = outputs_.find_existing(attributes_);
  warn_unusable(found.unusable);
  existing_ = fingerprints_.up_to_date(found.frames, [this](int frame) { return outputs_.path(frame); });
  std::vector<int> outdated;
  std::ranges::set_difference(found.frames, existing_, std::back_inserter(outdated));
  if (outdated.empty()) return;
  warn(fmt::format("{} made again, since the frames that they were made from have changed: {}",
                   counted(outdated.size(), "frame is", "frames are"), io::format_frame_range(outdated)));
}

io::LoadedFrame DenoiseJob::read(int frame) {
  const ProfileScope scope(profile_, "read");
  progress_->detail(fmt::format("frame {}: reading {}", frame, inputs_.path(frame)));
  fingerprints_.take(frame);
  return read_pixels(frame);
}

io::LoadedFrame DenoiseJob::read_pixels(int frame) const {
  io::LoadedFrame loaded = read_file(inputs_.path(frame), frame);
  if (inputs_.other_half()) {
    const std::string other = inputs_.other_half()->path(frame);
    join_halves(loaded, read_file(other, frame), other);
  }
  return loaded;
}

io::LoadedFrame DenoiseJob::read_file(const std::string& path, int frame) const {
  if (!filter_.denoises_additive()) {
    return io::read_exr(path, frame, filter_.wanted(), layers_, io::LightGroups::leave, window_.window);
  }
  io::LoadedFrame loaded = io::read_exr(path, frame, filter_.wanted() | filter::additive_aovs(), layers_,
                                        io::LightGroups::read, window_.window);
  leave_other_parts(loaded);
  std::ranges::for_each(loaded.other_views, leave_other_parts);
  return loaded;
}

/// --strict: what an audit finds in the frames is an error.
void DenoiseJob::require_sound_input(const std::vector<int>& frames) const {
  const std::vector<FrameFinding> findings =
      audit_frames(frames, [this](int frame) { return read_pixels(frame); });
  if (findings.empty()) return;
  for (const FrameFinding& finding : findings) warn(finding.text());
  throw Error(ExitStatus::bad_input,
              fmt::format("{}: --strict: {}; nothing was written", inputs_.pattern().text(),
                          counted(findings.size(), "finding", "findings")));
}

std::string DenoiseJob::halves_text() const {
  return fmt::format("{} and {} hold a half of the samples each; their mean is denoised",
                     inputs_.pattern().text(), inputs_.other_half()->text());
}

void DenoiseJob::warn_once(const std::string& line) {
  if (said_.insert(line).second) progress_->warn(line);
}

void DenoiseJob::write(DenoisedFile& result) {
  for (const int number : inputs_.outputs_of(result.frame.number())) {
    if (existing_.contains(number)) {
      progress_->frame_kept(number);
      continue;
    }
    io::Attributes attributes = attributes_;
    for (auto& attribute : fingerprints_.of(result.frame.number()))
      attributes.push_back(std::move(attribute));
    if (std::string alpha = alpha_outcome(result.source, result.frame, result.other_views); !alpha.empty()) {
      attributes.emplace_back("becalm:alpha", std::move(alpha));
    }
    if (number != result.frame.number()) {
      attributes.emplace_back("becalm:held_from", std::to_string(result.frame.number()));
    }
    io::WriteReport report;
    {
      const ProfileScope scope(profile_, "write");
      report = io::write_denoised_exr(outputs_.path(number), result.frame, result.other_views, result.source,
                                      attributes, format_);
    }
    warn_overflows(*progress_, number, report, "--type float keeps them");
    if (report.lossless_instead) {
      warn_once("ZIP instead of the lossy compression, which would alter the channels passed on");
    }
    if (report.full_size_only) {
      warn_once("only the full size of mipmaps is written; the smaller levels show the noisy picture");
    }
    progress_->detail(fmt::format("frame {}: wrote {}", number, outputs_.path(number)));
    progress_->frame_written(number);
  }
}

}  // namespace

Command add_denoise(CLI::App& becalm) {
  CLI::App& parser = *becalm.add_subcommand("denoise", "Denoise a sequence of EXR files of any renderer");
  auto command = std::make_shared<DenoiseCommand>();
  parser
      .add_option(
          "input", command->inputs,
          "The EXR files, such as 'in/shot.####.exr', or one file; or two of halves of the samples, such "
          "as shot.b0.####.exr and shot.b1.####.exr, of which the second is found beside the first")
      ->required()
      ->expected(1, 2)
      ->check(not_empty())
      ->option_text("INPUT [OTHER_HALF]");
  parser
      .add_option("--frame", command->frame,
                  "The frame number of a single file (default: the one in its name, or 1)")
      ->option_text("N")
      ->group("Input");
  parser
      .add_option("--missing", command->missing,
                  "A frame of --frames that is not there: error stops before the first frame, skip writes "
                  "nothing for "
                  "it, hold writes the denoised frame before it again (default: error)")
      ->check(CLI::IsMember({"error", "skip", "hold"}))
      ->option_text("error|skip|hold")
      ->group("Input");
  add_layer_options(parser, command->layers);
  add_output_options(parser, command->output, "all on disk");
  parser
      .add_option("--type", command->type, "Type of the denoised channels (default: keep, that of the input)")
      ->check(CLI::IsMember({"half", "float", "keep"}))
      ->option_text("half|float|keep")
      ->group("Output");
  const std::span<const std::string_view> names = io::compression_names();
  std::set<std::string> compressions(names.begin(), names.end());
  compressions.insert("keep");
  parser
      .add_option(
          "--compression", command->compression,
          fmt::format(
              "Compression of the part that holds them: {} or keep, the input's; ZIP instead of a lossy one "
              "that would alter channels passed on (default: keep)",
              fmt::join(names, ", ")))
      ->check(CLI::IsMember(compressions))
      ->option_text("NAME")
      ->group("Output");
  CLI::Option* const only =
      parser
          .add_option("--only", command->only,
                      "Leave out every channel but those of the beauty, or all that are denoised")
          ->check(CLI::IsMember({"beauty", "denoised"}))
          ->option_text("beauty|denoised")
          ->group("Output");
  parser
      .add_option("--channels", command->channels,
                  "Leave out every channel but these: channels, layers, or beauty, joined by commas")
      ->delimiter(',')
      ->check(not_empty())
      ->excludes(only)
      ->option_text("NAME,...")
      ->group("Output");
  parser
      .add_flag("--dry-run", command->dry_run,
                "Check everything, print what would be read, as what, and written, and write nothing")
      ->group("Output");
  parser
      .add_flag("--strict", command->strict,
                "Audit some frames first, as info --audit does; what is found is an error (status 3)")
      ->group("Input");
  parser
      .add_option("--preset", command->preset,
                  "draft, balanced or final: speed against accuracy (default: balanced); paper: as published")
      ->option_text("NAME")
      ->group("Filter");
  add_filter_options(parser, command->filter);
  add_running_options(parser, command->running);
  parser.add_flag_callback(
      "--help-settings", [] { throw CLI::CallForVersion(settings_help(), 0); },
      "Print what --set takes and what the presets have, and exit");
  parser.footer(
      "Direct and indirect light, light groups (light.NAME) and layers that add up to the beauty\n"
      "are denoised with it and still add up.\n"
      "Every channel that is not denoised is passed on bit for bit.\n"
      "Examples:\n"
      "  becalm denoise 'in/shot.####.exr' -o 'out/shot.####.exr'\n"
      "  becalm denoise 'in/shot.####.exr' -o 'out/shot.####.exr' --frames 1-48 --preset final --missing "
      "hold\n");
  return {&parser, [command] {
            apply(command->running);
            catch_signals();
            if (command->layers.additive == "none") command->filter.assignments.push_back("additive=0");
            return DenoiseJob(*command).run();
          }};
}

}  // namespace becalm::app
