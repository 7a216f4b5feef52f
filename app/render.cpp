// becalm render: the tracer, and with --denoise the filter behind it, from a scene to a sequence of EXR
// files.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "app/adaptive_sampling.h"
#include "app/alpha_report.h"
#include "app/cancel.h"
#include "app/command.h"
#include "app/console.h"
#include "app/counted.h"
#include "app/eye_names.h"
#include "app/filter_stage.h"
#include "app/frame_sink.h"
#include "app/noise_report.h"
#include "app/options.h"
#include "app/outputs.h"
#include "app/pipeline.h"
#include "app/profile.h"
#include "app/progress.h"
#include "app/render_ahead.h"
#include "app/render_arguments.h"
#include "app/render_schedule.h"
#include "app/rendered_frames.h"
#include "app/scene_hash.h"
#include "app/scratch_files.h"
#include "app/time_budget.h"
#include "filter/merge/additive.h"
#include "frame/io/exr.h"
#include "frame/io/frame_range.h"
#include "frame/io/sequence.h"
#include "tracer/render.h"
#include "tracer/scene/load/load.h"

namespace becalm::app {
namespace {

constexpr FileMark kMark{.command = "render", .attribute = "becalm:version"};
constexpr FileMark kNoisyMark{.command = "render --keep-noisy", .attribute = "becalm:version"};

/// The attribute of a denoised frame that tells the frames it is made from.
constexpr const char* kMadeFrom = "becalm:made_from";

/// Share of --memory for the filters of all eyes' pilots, which have a quarter of a frame's pixels.
constexpr double kPilotsMemory = 0.2;

bool samples_adaptively(const RenderCommand& command) {
  return command.adaptive || command.noise_target;
}

FilterOptions options_of_frames(const RenderCommand& command) {
  FilterOptions options = command.filter;
  if (samples_adaptively(command)) options.memory_share = 1.0 - kPilotsMemory;
  return options;
}

/// What the filter wants of the tracer: a single sample has no halves.
AovSet filter_input(const FilterStage& filter, int spp) {
  AovSet wanted = filter.wanted();
  if (spp == 1)
    wanted.reset(static_cast<std::size_t>(Aov::half_a)).reset(static_cast<std::size_t>(Aov::half_b));
  return wanted;
}

/// The files of a frame: one, or where the pattern has a field for the eye one for each.
std::vector<io::SequencePattern> patterns_of(const std::string& pattern, const std::vector<Eye>& eyes) {
  if (!has_eye_field(pattern)) return {io::SequencePattern(pattern)};
  std::vector<io::SequencePattern> patterns;
  for (const Eye eye : eyes) patterns.emplace_back(pattern_of_eye(pattern, eye == Eye::right ? 1 : 0));
  return patterns;
}

/// One run of `becalm render`.
class RenderJob {
 public:
  RenderJob(const RenderCommand& command, tracer::Scene scene);
  ExitStatus run();

 private:
  bool has_segments() const { return filter_ && filter_->has_segments(); }
  void choose_noisy_files();
  void find_existing();
  void make_again();
  void remove_scratch_files() const;
  void start_progress(std::size_t frames_to_make, std::size_t steps_beside);
  void run_frame_by_frame(const std::vector<int>& work);
  void run_segments(const std::vector<int>& work);
  RenderedFrames rendered_frames();
  bool is_adaptive() const { return samples_adaptively(command_); }
  void tell_expected_noise();
  void run_steps(const std::vector<filter::Step>& steps,
                 const std::function<std::optional<io::LoadedFrame>(std::size_t)>& source);
  void write(FinishedFrame& finished, FrameSink& sink);
  void complete(Frame& result, Frame& noisy);

  io::Attributes render_attributes(const FileMark& mark, const AskedAovs& aovs,
                                   const std::string& color) const;

  const RenderCommand& command_;
  const ThreadLimit threads_;
  const AskedAovs asked_;
  std::optional<FilterStage> filter_;
  const AovSet rendered_;  ///< what was asked for and what the filter wants
  tracer::Scene scene_;
  const std::vector<std::string> scene_files_;
  const std::string scene_hash_;
  const Size size_;
  const std::vector<Eye> eyes_;
  std::optional<Outputs> outputs_;
  std::optional<RenderSchedule> schedule_;  ///< of the filter
  std::optional<NoisyFiles> noisy_files_;
  io::Attributes attributes_;
  std::set<int> existing_;
  std::deque<AdaptiveSampling> sampling_;  ///< of each eye
  std::vector<double> expected_errors_;    ///< of the written frames: means of expected_error
  std::optional<Progress> progress_;
  Profile profile_;
};

RenderJob::RenderJob(const RenderCommand& command, tracer::Scene scene)
    : command_(command),
      threads_(command.running.threads),
      asked_(asked_aovs(command)),
      filter_(command.preset.empty()
                  ? std::nullopt
                  : std::make_optional<FilterStage>(command.preset, options_of_frames(command))),
      rendered_(asked_.aovs | (filter_ ? filter_input(*filter_, command.spp) : AovSet())),
      scene_(std::move(scene)),
      scene_files_(files_of_scene(command.scene)),
      scene_hash_(scene_hash(scene_files_)),
      size_(size_of(command, scene_.description())),
      eyes_(eyes_of(command, scene_.description())) {
  const std::vector<int> frames = frames_of(command, scene_.description());
  outputs_.emplace("-o", patterns_of(command.output.pattern, eyes_), frames);
  outputs_->keep_apart_from(scene_files_);
  attributes_ = render_attributes(kMark, asked_, command.type);
  if (filter_) {
    schedule_.emplace(*filter_, frames, frame_step(command), scene_.description().frames.first,
                      scene_.description().frames.last);
    attributes_.back().second += ' ' + filter_->describe(schedule_->readable());
    attributes_.emplace_back("becalm:preset", command.preset);
    if (command.noise_target) filter_->measure_expected_errors();
  }
  choose_noisy_files();
}

/// A file for each frame that the filter will read: of a long scene, few are near the frames asked for.
void RenderJob::choose_noisy_files() {
  const bool kept = !command_.keep_noisy.empty();
  if (has_eye_field(command_.keep_noisy)) {
    throw Error(
        ExitStatus::usage,
        fmt::format("--keep-noisy {}: expected no %V: both eyes are views of one file", command_.keep_noisy));
  }
  if (!kept && !has_segments()) return;
  const std::string pattern =
      noisy_pattern(command_.keep_noisy, command_.output.pattern, eyes_.front(), outputs_->frames());
  const std::set<int> read = frames_in(schedule_->segments(outputs_->frames()));
  noisy_files_.emplace(NoisyFiles{
      .outputs =
          Outputs(kept ? "--keep-noisy" : "-o", {io::SequencePattern(pattern)}, {read.begin(), read.end()}),
      .attributes = render_attributes(kNoisyMark, {rendered_, asked_.light_groups},
                                      /*color=*/"float"),
      .preset = command_.preset});
  noisy_files_->outputs.keep_apart_from(scene_files_);
  std::vector<std::string> written;
  for (const int frame : outputs_->frames()) {
    for (std::size_t file = 0; file < outputs_->files(); ++file)
      written.push_back(outputs_->path(frame, file));
  }
  noisy_files_->outputs.keep_apart_from(written, "a frame of -o");
}

io::Attributes RenderJob::render_attributes(const FileMark& mark, const AskedAovs& aovs,
                                            const std::string& color) const {
  const std::string eye = command_.eye == "both" ? "" : " eye=" + command_.eye;
  const std::string sampling = command_.noise_target ? fmt::format(" noise_target={}", *command_.noise_target)
                               : command_.adaptive   ? " adaptive=yes"
                                                     : "";
  return {{kCommandAttribute, std::string(mark.command)},
          {"becalm:version", BECALM_VERSION},
          {"becalm:settings",
           fmt::format("scene={} size={}x{} spp={}{}{} aov_spp={} seed={} aovs={} color={} reproducible={}{}",
                       scene_hash_, size_.width, size_.height, command_.spp, sampling,
                       command_.checkerboard ? " checkerboard=yes" : "",
                       std::max(command_.spp, command_.aov_spp), command_.seed, format_aovs(aovs), color,
                       command_.running.reproducible ? "yes" : "no", eye)}};
}

void RenderJob::find_existing() {
  const auto find = [this](const Outputs& outputs, const io::Attributes& attributes, const FileMark& mark) {
    const auto of_frames = [&](int frame) { return of_frame(attributes, frame); };
    Outputs::Existing found = outputs.find_existing(of_frames, mark, command_.output.overwrite);
    warn_unusable(found.unusable);
    return std::move(found.frames);
  };
  existing_ = find(*outputs_, attributes_, kMark);
  if (noisy_files_)
    noisy_files_->existing = find(noisy_files_->outputs, noisy_files_->attributes, kNoisyMark);
  if (filter_) make_again();
}

/// Takes what is to be made again from the existing outputs.
void RenderJob::make_again() {
  std::vector<int> outdated;
  for (const int frame : existing_) {
    const std::string now = schedule_->made_from(frame);
    const auto differs = [&](const std::string& path) { return io::read_attribute(path, kMadeFrom) != now; };
    if (std::ranges::any_of(outputs_->paths(frame), differs)) outdated.push_back(frame);
  }
  for (const int frame : outdated) existing_.erase(frame);
  if (!outdated.empty()) {
    warn(fmt::format("{} made again, since other frames than before are read for them: {}",
                     counted(outdated.size(), "frame is", "frames are"),
                     io::format_frame_range(outdated, frame_step(command_))));
  }
  if (command_.keep_noisy.empty()) return;
  std::erase_if(existing_, [this](int frame) { return !noisy_files_->existing.contains(frame); });
}

ExitStatus RenderJob::run() {
  if (!command_.output.overwrite && !command_.output.resume) {
    outputs_->keep_foreign_files(kMark);
    if (noisy_files_) noisy_files_->outputs.keep_foreign_files(kNoisyMark);
  }
  outputs_->prepare();
  if (noisy_files_) noisy_files_->outputs.prepare();
  if (has_segments())
    remove_abandoned_scratch(command_.output.pattern, eyes_.front(), *outputs_, schedule_->readable());
  if (command_.output.resume) find_existing();
  const std::vector<int>& asked = outputs_->frames();

  // A filter without segments goes through every frame before the one that is missing.
  std::vector<int> work = up_to_last_missing(asked, existing_);
  if (!filter_ || has_segments()) std::erase_if(work, [&](int frame) { return existing_.contains(frame); });
  if (work.empty()) {
    remove_scratch_files();
    return all_there(asked.size(), command_.running.quiet);
  }

  if (filter_) {
    std::vector<FilteredView> views;
    for (const Eye eye : eyes_) {
      views.push_back({.name = name_of_eye(eye),
                       .available = rendered_,
                       .light_groups = asked_.light_groups ? scene_.description().light_groups
                                                           : std::vector<std::string>()});
    }
    filter_->build(size_.width, size_.height, views);
  }
  if (has_segments()) {
    run_segments(work);
  } else {
    run_frame_by_frame(work);
  }
  if (filter_) filter_->finish(profile_);
  if (progress_->written() == asked.size()) remove_scratch_files();
  if (command_.noise_target) tell_expected_noise();
  return conclude(*progress_, asked.size(), command_.running.profile ? &profile_ : nullptr);
}

/// What an earlier run has left and this one, as some outputs were there, had no need to read.
void RenderJob::remove_scratch_files() const {
  if (!noisy_files_ || !command_.keep_noisy.empty()) return;
  for (const int frame : noisy_files_->existing) {
    if (const auto warning = remove_scratch_file(noisy_files_->outputs.path(frame))) warn(*warning);
  }
}

/// `steps_beside`: of a filter that does not keep pace with the tracer.
void RenderJob::start_progress(std::size_t frames_to_make, std::size_t steps_beside) {
  progress_.emplace(ProgressOptions{
      .total = outputs_->frames().size(),
      .existing = existing_.size(),
      .work = frames_to_make,
      .steps = steps_beside,
      .unit = command_.noise_target ? "frames" : "samples",
      .units_per_frame = command_.noise_target ? 1.0
                                               : static_cast<double>(size_.width) * size_.height *
                                                     command_.spp * static_cast<double>(eyes_.size()),
      .quiet = command_.running.quiet,
      .verbose = command_.running.verbose});
  if (!command_.choice.empty()) progress_->note(command_.choice);
}

/// What became of --noise-target.
void RenderJob::tell_expected_noise() {
  if (expected_errors_.empty()) return;
  double sum = 0.0;
  for (const double error : expected_errors_) sum += error;
  progress_->note(noise_text(std::sqrt(sum / static_cast<double>(expected_errors_.size())),
                             *command_.noise_target, sampling_));
}

RenderedFrames RenderJob::rendered_frames() {
  tracer::RenderOptions options = render_options(command_, size_);
  options.aovs = rendered_;
  options.light_groups = asked_.light_groups;
  if (is_adaptive()) {
    FilterOptions of_pilots = command_.filter;
    of_pilots.memory_share = kPilotsMemory / static_cast<double>(eyes_.size());
    for (const Eye eye : eyes_) {
      options.eye = eye;
      sampling_.emplace_back(scene_, options, of_pilots,
                             AdaptiveSampling::Options{.noise_target = command_.noise_target,
                                                       .spp = command_.spp,
                                                       .halves = contains(rendered_, Aov::half_a)});
    }
  }
  return {scene_, options, eyes_, sampling_, noisy_files_ ? &*noisy_files_ : nullptr, *progress_, profile_};
}

void RenderJob::run_frame_by_frame(const std::vector<int>& work) {
  std::vector<filter::Step> steps;
  if (filter_) {
    for (const filter::Segment& segment : schedule_->segments(work)) {
      steps.insert(steps.end(), segment.begin(), segment.end());
    }
  } else {
    for (const int frame : work) steps.push_back({.frame = frame});
  }
  start_progress(steps.size(), 0);
  RenderedFrames frames = rendered_frames();
  run_steps(steps, [&](std::size_t step) { return frames.make(steps[step].frame); });
}

void RenderJob::run_segments(const std::vector<int>& work) {
  std::vector<filter::Segment> segments = schedule_->segments(work);
  std::set<int> needed = frames_in(segments);
  std::erase_if(needed, [&](int frame) { return noisy_files_->existing.contains(frame); });
  std::size_t steps = 0;
  for (const filter::Segment& segment : segments) steps += segment.size();
  start_progress(needed.size(), steps);
  for (const int frame : work) needed.erase(frame);
  if (!needed.empty()) {
    progress_->note(context_note(needed.size(), "rendered"));
  }
  RenderedFrames frames = rendered_frames();
  RenderAhead ahead(frames, *noisy_files_, std::move(segments), !command_.keep_noisy.empty(), *progress_);
  run_steps(ahead.steps(), [&](std::size_t step) { return ahead.next(step); });
  ahead.finish(progress_->written() == outputs_->frames().size());
}

void RenderJob::run_steps(const std::vector<filter::Step>& steps,
                          const std::function<std::optional<io::LoadedFrame>(std::size_t)>& source) {
  FrameSink sink(*outputs_, existing_, *progress_, profile_);
  run_pipeline(steps.size(),
               {.source = source,
                .filter = [&](std::size_t step, io::LoadedFrame noisy) -> std::optional<FinishedFrame> {
                  if (!filter_) return unfiltered(std::move(noisy));
                  if (has_segments()) progress_->update_filter(steps[step].frame, step);
                  return filter_->run(steps[step], std::move(noisy), *progress_, profile_);
                },
                .sink = [&](FinishedFrame finished) { write(finished, sink); }});
}

void RenderJob::write(FinishedFrame& finished, FrameSink& sink) {
  if (!sink.wants(finished.frame.number())) return;
  io::Attributes attributes = of_frame(attributes_, finished.frame.number());
  expected_errors_.insert(expected_errors_.end(), finished.expected_errors.begin(),
                          finished.expected_errors.end());
  if (filter_) {
    attributes.emplace_back(kMadeFrom, schedule_->made_from(finished.frame.number()));
    attributes.emplace_back("becalm:tiles", filter_->tiles());
    attributes.emplace_back("becalm:alpha",
                            alpha_outcome(finished.source, finished.frame, finished.other_views));
  }
  std::vector<io::WrittenView> views;
  for (std::size_t eye = 0; eye < eyes_.size(); ++eye) {
    Frame& result = eye == 0 ? finished.frame : finished.other_views[eye - 1];
    complete(result, eye == 0 ? finished.source.frame : finished.source.other_views[eye - 1].frame);
    views.push_back({name_of_eye(eyes_[eye]), &result});
  }
  const io::PixelType type = command_.type == "float" ? io::PixelType::float32 : io::PixelType::half;
  sink.write(finished.frame.number(), [&](const std::string& path, std::size_t file) {
    const bool one_each = outputs_->files() > 1;
    return io::write_exr(path, one_each ? std::vector{views[file]} : views, attributes, type);
  });
}

/// Gives a frame to be written what was asked for and not denoised, as `becalm denoise` passes it on.
void RenderJob::complete(Frame& result, Frame& noisy) {
  const bool has_additive = filter_ && filter_->denoises_additive();
  for (const AovInfo& entry : kAovTable) {
    if (entry.diagnostic || entry.aov == Aov::beauty) continue;
    if (has_additive && contains(filter::additive_aovs(), entry.aov)) continue;
    result.image(entry.aov) = contains(asked_.aovs, entry.aov) ? std::move(noisy.image(entry.aov)) : Image();
  }
  if (!has_additive) result.light_groups() = std::move(noisy.light_groups());
  result.set_stereo(noisy.stereo());
}

/// --debug-pixel: the path of one sample on standard output, and nothing written.
ExitStatus debug_pixel(const RenderCommand& command, tracer::Scene& scene) {
  const tracer::PixelSample pixel = parse_pixel_sample(command.debug_pixel);
  const int frame = frames_of(command, scene.description()).front();
  tracer::RenderOptions options = render_options(command, size_of(command, scene.description()));
  options.eye = eyes_of(command, scene.description()).front();
  options.aovs.set(static_cast<std::size_t>(Aov::albedo));  // a sample may be not finite in its guides alone
  for (const std::string& line : tracer::describe_sample(scene, frame, options, pixel))
    fmt::print("{}\n", line);
  return ExitStatus::done;
}

}  // namespace

Command add_render(CLI::App& becalm) {
  CLI::App& parser = *becalm.add_subcommand("render", "Render a scene to EXR files, denoised or not");
  auto command = std::make_shared<RenderCommand>();
  add_render_options(parser, *command);
  return {&parser, [command] {
            check_options_fit(*command);
            apply(command->running, command->filter);
            catch_signals();
            tracer::Scene scene = tracer::load_scene(command->scene);
            warn_each(scene.description().warnings);
            if (!command->time_budget.empty()) {
              const ThreadLimit threads(command->running.threads);
              choose_by_time(*command, scene);
            }
            set_defaults(*command, scene.description());
            if (!command->debug_pixel.empty()) return debug_pixel(*command, scene);
            return RenderJob(*command, std::move(scene)).run();
          }};
}

}  // namespace becalm::app
