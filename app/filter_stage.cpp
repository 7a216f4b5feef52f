#include "app/filter_stage.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "app/asked_aovs.h"
#include "app/counted.h"
#include "app/expected_error.h"
#include "app/eye_names.h"
#include "filter/input/host_images.h"
#include "filter/input/noise_ratio.h"
#include "filter/input/radiance_scale.h"
#include "filter/merge/additive.h"
#include "frame/error.h"
#include "frame/io/frame_range.h"
#include "frame/io/printable.h"

namespace becalm::app {

namespace {

/// Longer segments take more memory, shorter ones repeat more frames. With this warm-up seams have the
/// temporal error of other frames (`scripts/bench quality`).
constexpr int kSegment = 32;
constexpr int kWarmup = 8;

}  // namespace

FilterStage::FilterStage(FilterRecipe recipe, const FilterOptions& options)
    : recipe_(std::move(recipe)),
      diagnostics_(diagnostics_of(options)),
      alpha_(options.alpha == "denoise" ? filter::Alpha::denoise : filter::Alpha::keep),
      denoises_additive_(recipe_.takes_additive && options.additive != "none"),
      device_options_(device_options(options)),
      memory_limit_(options),
      segment_(options.segment.value_or(recipe_.directions == filter::Directions::both ? kSegment : 0)),
      context_(options.context),
      cuts_(options.cuts),
      stereo_(options.stereo) {
  if (cuts_ != "auto" && cuts_ != "none") {
    const std::vector<int> cuts = io::parse_frame_range(cuts_, "--cuts");
    given_cuts_ = {cuts.begin(), cuts.end()};
  }
  if (options.warmup && !has_segments()) {
    throw Error(ExitStatus::usage,
                fmt::format("--warmup {}: a forward filter's history is unbounded; --segment "
                            "bounds it",
                            *options.warmup));
  }
  warmup_ = has_segments() ? options.warmup.value_or(kWarmup) : 0;
  context_frames();  // throws if --context is no range
}

std::string FilterStage::describe(const std::vector<int>& readable) const {
  const std::string history = has_segments() ? fmt::format("segment={} warmup={} context={}", segment_,
                                                           warmup_, context_.empty() ? "all" : context_)
                                             : fmt::format("first_frame={}", readable.front());
  const std::string stereo = stereo_ == false ? " stereo=no" : "";
  return fmt::format("{} alpha={} additive={} diagnostics={} cuts={} {}{}", recipe_.settings,
                     recipe_.averages_alpha             ? "average"
                     : alpha_ == filter::Alpha::denoise ? "denoise"
                                                        : "keep",
                     denoises_additive_ ? "yes" : "no", diagnostics_.any() ? "yes" : "no", cuts_, history,
                     stereo);
}

std::vector<int> FilterStage::readable(const std::vector<int>& asked,
                                       const std::vector<int>& existing) const {
  if (context_.empty() && has_segments()) return existing;
  std::vector<int> allowed;
  std::ranges::set_union(asked, context_frames(), std::back_inserter(allowed));
  std::vector<int> readable;
  std::ranges::set_intersection(existing, allowed, std::back_inserter(readable));
  return readable;
}

std::vector<int> FilterStage::context_frames() const {
  if (context_.empty() || context_ == "none") return {};
  return io::parse_frame_range(context_, "--context");
}

std::vector<filter::Segment> FilterStage::schedule(const std::vector<int>& readable,
                                                   const std::set<int>& wanted, int step) const {
  return filter::schedule(readable, wanted,
                          {.directions = recipe_.directions,
                           .segment = segment_,
                           .warmup = warmup_,
                           .step = step,
                           .cuts = given_cuts_});
}

void FilterStage::build(int width, int height, const std::vector<FilteredView>& views,
                        const Imath::V2i& origin) {
  const bool are_pair = recipe_.make_pair && views.size() == 2 && are_eyes(views[0].name, views[1].name);
  if (stereo_ == true && !are_pair) {
    std::vector<std::string> names;
    names.reserve(views.size());
    for (const FilteredView& view : views) names.push_back(io::printable(view.name));
    throw Error(ExitStatus::bad_input,
                fmt::format("--stereo: expected two views, left and right, and the frames have {}",
                            views.size() == 1 ? "one" : fmt::format("'{}'", fmt::join(names, ","))));
  }
  const bool pairs = are_pair && stereo_.value_or(true);
  const auto additive = [&](const FilteredView& view) { return view.available & filter::additive_aovs(); };
  if (pairs && denoises_additive_ &&
      (views[0].light_groups != views[1].light_groups || additive(views[0]) != additive(views[1]))) {
    throw Error(ExitStatus::bad_input,
                "the eyes have other light groups, or direct and indirect light in one of them alone; "
                "--no-stereo filters each by itself");
  }
  open_device();
  const std::uint64_t memory = memory_limit_.bytes_of(*device_);
  AovSet common = AovSet().set();
  for (const FilteredView& view : views) common &= view.available;
  const auto make = [&](const auto& maker, AovSet available, const std::vector<std::string>& light_groups,
                        std::uint64_t limit) {
    if (!denoises_additive_) available &= ~filter::additive_aovs();
    return maker(
        *device_, width, height, available,
        filter::SequenceOptions{.diagnostics = diagnostics_,
                                .memory_limit = limit,
                                .find_cuts = cuts_ == "auto" ? filter::FindCuts::yes : filter::FindCuts::no,
                                .alpha = alpha_,
                                .light_groups = denoises_additive_ ? light_groups.size() : 0,
                                .origin = origin});
  };
  if (pairs) pair_ = make(recipe_.make_pair, common, views[0].light_groups, memory);
  for (const FilteredView& view : views) {
    views_.push_back({view.name.empty() ? "" : ' ' + io::printable(view.name), nullptr});
    if (!pairs) {
      views_.back().filter = make(recipe_.make, view.available, view.light_groups, memory / views.size());
    }
  }
  matched_ = recipe_.describe_matching(pairs ? common : views.front().available);
  if (!pairs) return;
  AovSet of_one_eye = (views[0].available | views[1].available) & ~common;
  if (!denoises_additive_) of_one_eye &= ~filter::additive_aovs();
  if (of_one_eye.any())
    matched_ += fmt::format("; not used, since one eye alone has them: {}", format_aovs({of_one_eye}));
}

const std::string& FilterStage::open_device() {
  if (!device_) device_.emplace(device_options_);
  return device_->info().name;
}

void FilterStage::require_size(const std::string& path, const Imath::Box2i& window) {
  if (!recipe_.size_problem) return;
  open_device();
  const std::string problem = recipe_.size_problem(*device_, window);
  if (!problem.empty()) throw Error(ExitStatus::resource, fmt::format("{}: {}", path, problem));
}

std::string FilterStage::views_text() const {
  if (pair_) return "the eyes are filtered together: each is one more source of the other";
  return views_.size() > 1 ? "each view is filtered by itself" : "";
}

std::optional<FinishedFrame> FilterStage::run(const filter::Step& step, io::LoadedFrame noisy,
                                              Progress& progress, Profile& profile) {
  std::vector<const Frame*> frames{&noisy.frame};
  for (const io::LoadedView& view : noisy.other_views) frames.push_back(&view.frame);
  if (noisy.other_eye) frames.push_back(&noisy.other_eye->frame);
  std::vector<filter::FrameReport> reports(frames.size());
  std::vector<double> expected_errors;
  std::vector<Frame> made = run_scaled(step, frames, reports, expected_errors, profile);
  if (!matched_.empty()) {
    progress.detail(fmt::format("device {}", device_->info().name));
    progress.detail(fmt::format("tiles {}", tiles()));
    progress.note(std::exchange(matched_, {}));
    if (!views_text().empty()) progress.note(views_text());
  }
  for (const filter::FrameReport& report : reports) profile.add(report.passes);
  if (made.empty()) return std::nullopt;
  for (std::size_t view = 0; view < views_.size(); ++view) {
    tell(reports[view], fmt::format("frame {}{}", made[view].number(), views_[view].name), progress);
  }
  Frame first = std::move(made.front());
  made.erase(made.begin());
  return FinishedFrame{std::move(first), std::move(made), std::move(noisy), std::move(expected_errors)};
}

std::vector<Frame> FilterStage::run_scaled(const filter::Step& step, const std::vector<const Frame*>& frames,
                                           std::vector<filter::FrameReport>& reports,
                                           std::vector<double>& expected_errors, Profile& profile) {
  const float scale = recipe_.scales_radiance ? 1.0f : filter::radiance_scale(*frames.front());
  filter::Step scaled_step = step;
  scaled_step.new_history |= scale != radiance_scale_;
  radiance_scale_ = scale;
  std::vector<Frame> scaled;
  std::vector<const Frame*> pointers = frames;
  if (scale != 1.0f) {
    for (const Frame* frame : frames) filter::scale_radiance(scaled.emplace_back(*frame), scale);
    std::ranges::transform(scaled, pointers.begin(), [](const Frame& frame) { return &frame; });
  }
  std::vector<Frame> made = run_views(scaled_step, pointers, reports, profile);
  for (std::size_t view = 0; view < made.size(); ++view) {
    if (measures_errors_) {
      expected_errors.push_back(
          mean_expected_error(made[view], filter::exposure(pointers[view]->image(Aov::beauty))));
    }
    if (scale != 1.0f) filter::scale_radiance_back(made[view], scale, *frames[view]);
  }
  return made;
}

std::vector<Frame> FilterStage::run_views(const filter::Step& step, const std::vector<const Frame*>& frames,
                                          std::vector<filter::FrameReport>& reports, Profile& profile) {
  const ProfileScope scope(profile,
                           step.direction == filter::Direction::forward ? "filter" : "filter backward");
  std::vector<Frame> made;
  const auto keep = [&](std::optional<Frame> frame) {
    if (frame) made.push_back(std::move(*frame));
  };
  if (pair_) {
    std::array<filter::FrameReport, 2> of_eyes;
    for (std::optional<Frame>& frame : pair_->run(step, {frames[0], frames[1]}, of_eyes)) {
      keep(std::move(frame));
    }
    std::ranges::move(of_eyes, reports.begin());
    return made;
  }
  for (std::size_t view = 0; view < frames.size(); ++view) {
    keep(views_[view].filter->run(step, *frames[view], reports[view]));
  }
  return made;
}

void FilterStage::tell(const filter::FrameReport& report, const std::string& name, Progress& progress) {
  progress.detail(fmt::format("{}: {:.3g} frames a pixel on average, {:.0f} % of the history rejected", name,
                              report.mean_sample_count, 100.0 * report.mean_rejected));
  if (report.new_shot) progress.note(fmt::format("{}: a new shot begins", name));
  if (report.noise_ratio >= filter::kSharedNoise && !std::exchange(has_told_of_shared_noise_, true)) {
    progress.warn(
        fmt::format("{}: neighbouring pixels share noise, of which more will stay: the renderer seems to "
                    "weigh samples by its pixel filter; a box filter of one pixel, or filter importance "
                    "sampling, avoids that",
                    name));
  }
  if (report.non_finite_pixels > 0) {
    progress.warn(
        fmt::format("{}: {} pixels with NaN or Inf stay as they came", name, report.non_finite_pixels));
  }
  if (report.non_finite_guides > 0) {
    progress.warn(fmt::format("{}: {} pixels with NaN or Inf in albedo, normal or depth: these were replaced",
                              name, report.non_finite_guides));
  }
  if (report.replaced_variances > 0) {
    progress.warn(fmt::format("{}: {} variances that are negative or not finite were taken as pure noise",
                              name, report.replaced_variances));
  }
  if (report.far_motions > 0) {
    progress.warn(
        fmt::format("{}: {} pixels move too far from frame to frame for their motion to be a candidate", name,
                    report.far_motions));
  }
  if (report.replaced_additive > 0) {
    progress.warn(
        fmt::format("{}: {} values of direct, indirect or light groups with NaN or Inf were taken as 0", name,
                    report.replaced_additive));
  }
}

filter::FilterMemory FilterStage::memory_of(std::size_t view) const {
  return pair_ ? pair_->memory() : views_[view].filter->memory();
}

void FilterStage::finish(Profile& profile) const {
  if (views_.empty()) return;
  filter::FilterMemory memory = memory_of(0);
  for (std::size_t view = 1; !pair_ && view < views_.size(); ++view) {
    memory += memory_of(view);
  }
  profile.set_device(device_->info().name, memory);
  check_validation(*device_);
}

std::string context_note(std::size_t frames, std::string_view work) {
  return fmt::format("{} {} for those before and after them; --context none does without",
                     counted(frames, "frame more is", "frames more are"), work);
}

}  // namespace becalm::app
