#include "app/sequence_job.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <utility>

#include "app/alpha_report.h"
#include "app/audit_run.h"
#include "app/console.h"
#include "app/counted.h"
#include "app/eye_names.h"
#include "app/given_jitter.h"
#include "app/given_stereo.h"
#include "app/input_pixels.h"
#include "frame/audit/audit.h"
#include "frame/io/frame_range.h"
#include "frame/io/jitter_text.h"
#include "frame/io/sequence.h"

namespace becalm::app {

namespace {

/// One pattern, or one of each eye.
std::vector<io::SequencePattern> output_patterns(const SequenceCommand& command, const InputFrames& inputs) {
  const std::string& text = command.output.pattern;
  if (command.eyes != has_eye_field(text)) {
    throw Error(
        ExitStatus::usage,
        command.eyes
            ? fmt::format("-o {}: expected %V (left, right) or %v (l, r) in it: each eye has a file", text)
            : fmt::format("-o {}: has a field for the eye, and the input is one file a frame", text));
  }
  if (!command.eyes) return {inputs.output_pattern(text)};
  return {inputs.output_pattern(pattern_of_eye(text, 0)), inputs.output_pattern(pattern_of_eye(text, 1))};
}

/// Gives the memory back of what the filter has read and the writer takes from the file.
void drop_filtered(io::LoadedFrame& source) {
  const auto drop = [](Frame& frame) {
    for (const AovInfo& entry : kAovTable) {
      if (entry.aov != Aov::beauty) frame.remove(entry.aov);
    }
  };
  drop(source.frame);
  for (io::LoadedView& view : source.other_views) drop(view.frame);
  if (source.other_eye) drop(source.other_eye->frame);
}

InputFrames::Pair pair_of(const SequenceCommand& command) {
  if (command.eyes) return InputFrames::Pair::eyes;
  return command.finds_halves ? InputFrames::Pair::halves : InputFrames::Pair::none;
}

}  // namespace

SequenceJob::SequenceJob(const SequenceCommand& command, FilterRecipe recipe)
    : command_(command),
      mark_{.command = command.name, .attribute = "becalm:inputs"},
      threads_(command.running.threads),
      layers_(layer_options(command.layers)),
      filter_(std::move(recipe), command.filter),
      format_(format_of(command, filter_.keeps_alpha())),
      inputs_(command.inputs, pair_of(command), command.output.frames, command.frame,
              parse_missing(command.missing),
              [this](const auto& asked, const auto& on_disk) { return filter_.readable(asked, on_disk); }),
      outputs_("-o", output_patterns(command, inputs_), inputs_.outputs()),
      noisy_image_(take_noisy_image(all_files(), layers_)),
      window_(find_window(inputs_, layers_)),
      fingerprints_(inputs_, filter_, layers_, window_) {
  std::vector<std::string> paths;
  for (const int frame : inputs_.readable())
    std::ranges::copy(inputs_.paths(frame), std::back_inserter(paths));
  outputs_.keep_apart_from(paths);
}

/// Of all frames of the sequence on disk, or of the single frame.
std::vector<NumberedFile> SequenceJob::all_files() const {
  std::vector<NumberedFile> files;
  if (!inputs_.pattern().has_frame_field()) {
    const int frame = inputs_.readable().front();
    for (const std::string& path : inputs_.paths(frame)) files.push_back({frame, path});
    return files;
  }
  files = files_on_disk(inputs_.pattern());
  for (const auto& other : {inputs_.other_half(), inputs_.other_eye()}) {
    if (other) std::ranges::move(files_on_disk(*other), std::back_inserter(files));
  }
  return files;
}

void SequenceJob::choose_additive() {
  if (!filter_.denoises_additive()) return;
  AdditiveChoice choice = app::choose_additive(command_.layers.additive, all_files(), layers_);
  layers_.additive = std::move(choice.layers);
  layers_.with_usual_lights = choice.with_usual_lights;
  additive_notes_ = std::move(choice.notes);
  // Also where there are none: files that were written with some must not be kept beside others.
  attributes_.emplace_back("becalm:additive", layers_.additive.empty()
                                                  ? "none"
                                                  : fmt::format("{}", fmt::join(layers_.additive, ",")));
}

void SequenceJob::set_attributes() {
  attributes_ = {{kCommandAttribute, command_.name},
                 {"becalm:version", BECALM_VERSION},
                 {"becalm:settings", settings()},
                 {"becalm:preset", command_.preset}};
  // The results have no one place in their pixels, whatever the input's samples had.
  if (filter_.averages_alpha()) attributes_.emplace_back(io::kJitterAttribute, "none");
  if (filter_.checkerboards() != Checkerboards::refused)
    attributes_.emplace_back(io::kCheckerboardAttribute, "none");
  choose_additive();
}

ExitStatus SequenceJob::run() {
  for (const std::string& note : inputs_.notes()) warn(note);
  set_attributes();
  if (!command_.output.overwrite && !command_.output.resume) outputs_.keep_foreign_files(mark_);
  command_.dry_run ? outputs_.check_places() : outputs_.prepare();
  if (command_.output.resume) find_existing();
  // Without segments every frame depends on all before it.
  const std::set<int> wanted =
      filter_.has_segments() ? inputs_.sources_of_missing(existing_) : inputs_.up_to_last_missing(existing_);
  const std::size_t asked = outputs_.frames().size();
  if (wanted.empty()) return all_there(asked, command_.running.quiet);

  std::size_t work = 0;  // a frame that is held for others is written for each of them
  for (const int frame : wanted) work += std::max<std::size_t>(inputs_.outputs_of(frame).size(), 1);
  progress_.emplace(ProgressOptions{.total = asked,
                                    .existing = existing_.size(),
                                    .work = work,
                                    .quiet = command_.running.quiet,
                                    .verbose = command_.running.verbose});
  std::vector<filter::Step> steps;
  for (const filter::Segment& segment : filter_.schedule(inputs_.readable(), wanted, inputs_.step())) {
    steps.insert(steps.end(), segment.begin(), segment.end());
  }
  std::set<int> needed;
  for (const filter::Step& step : steps) needed.insert(step.frame);
  const std::vector<InputLayout> views = checked_inputs(needed);
  filter_.require_size(inputs_.path(*needed.begin()), window_.window);
  if (command_.dry_run) {
    print_plan(needed);
    return ExitStatus::done;
  }
  progress_->detail(fmt::format("{}x{} px of {}", window_.width(), window_.height(),
                                fingerprints_.layers_of(*needed.begin())));
  const auto prepare = [&] {
    build_filter(views);
    tell_what_is_taken(needed, wanted);
  };
  filter_all(steps, static_cast<double>(work) / static_cast<double>(steps.size()), prepare);
  return conclude(*progress_, asked, command_.running.profile ? &profile_ : nullptr);
}

void SequenceJob::build_filter(const std::vector<InputLayout>& views) {
  std::vector<FilteredView> filtered;
  filtered.reserve(views.size());
  for (const InputLayout& view : views) {
    filtered.push_back({.name = view.view, .available = view.aovs, .light_groups = view.light_groups});
  }
  filter_.build(window_.width(), window_.height(), filtered, window_.window.min);
}

std::vector<InputLayout> SequenceJob::checked_inputs(const std::set<int>& needed) {
  std::vector<InputLayout> views = check_inputs(inputs_, needed, filter_, layers_, format_);
  lights_ = views.front().light_groups;
  if (!command_.stereo_camera.empty() && !inputs_.other_eye() && views.size() != 2) {
    throw Error(ExitStatus::usage,
                fmt::format("--stereo-camera {}: {} has {}, expected two eyes", command_.stereo_camera,
                            inputs_.path(*needed.begin()), counted(views.size(), "view", "views")));
  }
  if (command_.strict) require_sound_input({needed.begin(), needed.end()});
  io::check_selection(inputs_.path(*needed.begin()), layers_, format_.channels, "--channels");
  return views;
}

/// Notes and warnings on the frames that are read, `needed`, for those that are written, `wanted`.
void SequenceJob::tell_what_is_taken(const std::set<int>& needed, const std::set<int>& wanted) {
  if (!command_.choice.empty()) progress_->note(command_.choice);
  if (inputs_.other_half()) progress_->note(halves_text());
  if (format_.channels.names != std::vector<std::string>{"beauty"}) {  // which leaves them out
    for (const AdditiveNote& note : additive_notes_)
      note.is_warning ? progress_->warn(note.text) : progress_->note(note.text);
  }
  if (noisy_image_) progress_->warn(noisy_image_->text());
  const auto asked_for = [&](int frame) { return wanted.contains(frame); };
  if (const auto more = needed.size() - std::ranges::count_if(needed, asked_for); more > 0)
    progress_->note(context_note(more, "read and filtered"));
  tell_other_beauties(inputs_.path(*needed.begin()));
  if (!inputs_.has_numbers()) {
    progress_->note(
        fmt::format("{}: no frame number in the name, so this is frame 1; --frame N says otherwise",
                    inputs_.pattern().text()));
  }
}

void SequenceJob::filter_all(const std::vector<filter::Step>& steps, double work_per_step,
                             const std::function<void()>& prepare) {
  FrameSink sink(outputs_, existing_, *progress_, profile_);
  run_pipeline(steps.size(), {.prepare = prepare,
                              .source = [&](std::size_t step) { return std::optional(read(steps[step])); },
                              .filter =
                                  [&](std::size_t step, io::LoadedFrame noisy) {
                                    progress_->update(steps[step].frame,
                                                      work_per_step * static_cast<double>(step));
                                    std::optional<FinishedFrame> made =
                                        filter_.run(steps[step], std::move(noisy), *progress_, profile_);
                                    if (made) drop_filtered(made->source);
                                    return made;
                                  },
                              .sink = [&](const FinishedFrame& finished) { write(finished, sink); }});
  filter_.finish(profile_);
}

/// View layers that stay noisy, unless the user chose the channels to write, or the one that is denoised.
void SequenceJob::tell_other_beauties(const std::string& path) {
  if (!format_.channels.selects_all()) return;
  if (layers_.layers.contains(Aov::beauty) && !noisy_image_) return;
  const std::vector<std::string> others = io::describe_exr(path, layers_).other_beauties;
  if (others.empty()) return;
  progress_->warn(fmt::format("{} {} passed on noisy; --layers beauty=NAME denoises another view layer",
                              fmt::join(others, ", "), others.size() == 1 ? "is" : "are"));
}

io::LoadedFrame SequenceJob::first_frame() const {
  return read_pixels(inputs_, inputs_.readable().front(), filter_, layers_, window_);
}

/// What decides the bytes of an output, besides the frames that it is made from.
std::string SequenceJob::settings() const {
  return fmt::format("{} reproducible={}{}{}", filter_.describe(inputs_.readable()),
                     command_.running.reproducible ? "yes" : "no", describe(command_.layers),
                     describe_output(command_));
}

/// --dry-run: what would be read, as what, and written, on standard output.
void SequenceJob::print_plan(const std::set<int>& needed) {
  const std::string& device = filter_.open_device();
  std::vector<int> written;
  std::ranges::set_difference(outputs_.frames(), existing_, std::back_inserter(written));
  const auto print = [](const char* verb, const std::string& pattern, const std::vector<int>& frames) {
    fmt::print("{} {}: {}, {}\n", verb, pattern, counted(frames.size(), "frame", "frames"),
               io::format_frame_range(frames));
  };
  print("reads", inputs_.pattern().text(), {needed.begin(), needed.end()});
  if (inputs_.other_eye()) print("reads", inputs_.other_eye()->text(), {needed.begin(), needed.end()});
  fmt::print(
      "takes {}x{} px of {}; {}\n", window_.width(), window_.height(),
      fingerprints_.layers_of(*needed.begin()),
      format_.channels.selects_all() ? "passes on every other channel" : "leaves channels out as told");
  if (!lights_.empty()) fmt::print("denoises the lights {} with it\n", fmt::join(lights_, ", "));
  if (inputs_.other_half()) fmt::print("{}\n", halves_text());
  if (noisy_image_) fmt::print("{}\n", noisy_image_->text());
  for (const AdditiveNote& note : additive_notes_) fmt::print("{}\n", note.text);
  fmt::print("filters with preset {} on {}: {}\n", command_.preset, device, settings());
  if (!existing_.empty()) print("keeps", command_.output.pattern, {existing_.begin(), existing_.end()});
  print("writes", command_.output.pattern, written);
  std::erase_if(written, [&](int frame) {
    return std::ranges::none_of(outputs_.paths(frame), [](const std::string& path) {
      std::error_code error;
      return std::filesystem::exists(path, error);
    });
  });
  if (!written.empty()) print("replaces", command_.output.pattern, written);
}

void SequenceJob::find_existing() {
  constexpr std::size_t most_untold = 50;
  if (outputs_.frames().size() > most_untold && !command_.running.quiet)
    say(fmt::format("--resume: checking which of {} frames are there", outputs_.frames().size()));
  Outputs::Existing found =
      outputs_.find_existing([this](int) { return attributes_; }, mark_, command_.output.overwrite);
  warn_unusable(found.unusable);
  existing_ = fingerprints_.up_to_date(found.frames, [this](int frame) { return outputs_.paths(frame); });
  std::vector<int> outdated;
  std::ranges::set_difference(found.frames, existing_, std::back_inserter(outdated));
  if (outdated.empty()) return;
  warn(fmt::format("{} made again, since the frames that they were made from have changed: {}",
                   counted(outdated.size(), "frame is", "frames are"), io::format_frame_range(outdated)));
}

io::LoadedFrame SequenceJob::read(const filter::Step& step) {
  const int frame = step.frame;
  const ProfileScope scope(profile_, "read");
  progress_->detail(fmt::format("frame {}: reading {}", frame, inputs_.path(frame)));
  fingerprints_.take(frame);
  const bool keeps = step.wanted && step.direction == filter::Direction::forward && format_.scale.is_one();
  io::LoadedFrame loaded = read_pixels(inputs_, frame, filter_, layers_, window_,
                                       keeps ? io::KeepPassedOn::yes : io::KeepPassedOn::no);
  if (inputs_.other_half() && !told_of_same_halves_) {
    if (const auto finding = audit::check_same_halves({loaded.frame})) {
      progress_->warn(fmt::format("frame {}: {}", frame, finding->text));
      told_of_same_halves_ = true;
    }
  }
  if (command_.jitter != "auto") {
    loaded.frame.set_jitter(given_jitter(command_.jitter, frame));
    for (io::LoadedView& view : loaded.other_views) view.frame.set_jitter(loaded.frame.jitter());
  }
  if (!command_.stereo_camera.empty()) {
    const GivenStereo given = given_stereo(command_.stereo_camera);
    if (loaded.other_eye) {
      give_stereo(given, Eye::left, loaded);
      give_stereo(given, Eye::right, *loaded.other_eye);
    } else if (loaded.other_views.size() == 1) {
      const bool left_first = is_eye(loaded.view, Eye::left);
      give_stereo(given, left_first ? Eye::left : Eye::right, loaded);
      give_stereo(given, left_first ? Eye::right : Eye::left, loaded.other_views.front());
    }
  }
  if (filter_.checkerboards() == Checkerboards::as_told) {
    const Parity parity = given_checkerboard(command_.checkerboard, frame, window_.window.min);
    if (loaded.frame.checkerboard().value_or(parity) != parity) {
      throw Error(ExitStatus::bad_input,
                  fmt::format("{}: holds the other pixels than --checkerboard={} says, by its "
                              "becalm:checkerboard; --checkerboard alone goes by that",
                              inputs_.path(frame), command_.checkerboard));
    }
    loaded.frame.set_checkerboard(parity);
    for (io::LoadedView& view : loaded.other_views) view.frame.set_checkerboard(parity);
  }
  return loaded;
}

/// --strict: what an audit finds in the frames is an error.
void SequenceJob::require_sound_input(const std::vector<int>& frames) const {
  const std::vector<FrameFinding> findings = audit_frames(
      frames, [this](int frame) { return read_pixels(inputs_, frame, filter_, layers_, window_); });
  if (findings.empty()) return;
  for (const FrameFinding& finding : findings) warn(finding.text());
  throw Error(ExitStatus::bad_input,
              fmt::format("{}: --strict: {}; nothing was written", inputs_.pattern().text(),
                          counted(findings.size(), "finding", "findings")));
}

std::string SequenceJob::halves_text() const {
  return fmt::format("{} and {} hold a half of the samples each; their mean is taken (else --no-halves)",
                     inputs_.pattern().text(), inputs_.other_half()->text());
}

void SequenceJob::write(const FinishedFrame& result, FrameSink& sink) {
  const int source = result.frame.number();
  for (const int number : inputs_.outputs_of(source)) {
    if (!sink.wants(number)) continue;
    io::Attributes attributes = attributes_;
    attributes.emplace_back("becalm:tiles", filter_.tiles());
    for (auto& attribute : fingerprints_.of(source)) attributes.push_back(std::move(attribute));
    std::string alpha = filter_.averages_alpha()
                            ? "antialiased"
                            : alpha_outcome(result.source, result.frame, result.other_views);
    if (!alpha.empty()) attributes.emplace_back("becalm:alpha", std::move(alpha));
    if (number != source) attributes.emplace_back("becalm:held_from", std::to_string(source));
    sink.write(number, [&](const std::string& path, std::size_t file) {
      if (!result.source.other_eye) {
        return io::write_denoised_exr(path, result.frame, result.other_views, result.source, attributes,
                                      format_);
      }
      return file == 0 ? io::write_denoised_exr(path, result.frame, {}, result.source, attributes, format_)
                       : io::write_denoised_exr(path, result.other_views.back(), {}, *result.source.other_eye,
                                                attributes, format_);
    });
  }
}

}  // namespace becalm::app
