#include "app/filter_stage.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "filter/merge/additive.h"
#include "frame/error.h"
#include "frame/io/printable.h"
#include "frame/io/sequence.h"

namespace becalm::app {

namespace {

/// Chosen by the curves in filter/README.md.
constexpr int kSegment = 32;
constexpr int kWarmup = 8;

}  // namespace

FilterStage::FilterStage(FilterRecipe recipe, const FilterOptions& options)
    : recipe_(std::move(recipe)),
      diagnostics_(diagnostics_of(options)),
      alpha_(options.alpha == "denoise" ? filter::Alpha::denoise : filter::Alpha::keep),
      denoises_additive_(recipe_.takes_additive && options.additive != "none"),
      device_options_(device_options(options)),
      memory_limit_(memory_limit(options)),
      segment_(options.segment.value_or(recipe_.directions == filter::Directions::both ? kSegment : 0)),
      context_(options.context),
      cuts_(options.cuts) {
  if (cuts_ != "auto" && cuts_ != "none") {
    const std::vector<int> cuts = io::parse_frame_range(cuts_);
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
  const std::string history = has_segments()
                                  ? fmt::format("segment={} warmup={} context={}", segment_, warmup_,
                                                context_.empty()     ? "all"
                                                : context_ == "none" ? io::format_frame_range(readable)
                                                                     : context_)
                                  : fmt::format("first_frame={}", readable.front());
  return fmt::format("{} alpha={} additive={} diagnostics={} cuts={} {}", recipe_.settings,
                     recipe_.averages_alpha             ? "average"
                     : alpha_ == filter::Alpha::denoise ? "denoise"
                                                        : "keep",
                     denoises_additive_ ? "yes" : "no", diagnostics_.any() ? "yes" : "no", cuts_, history);
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
  return io::parse_frame_range(context_);
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

void FilterStage::build(int width, int height, AovSet available, std::size_t light_groups,
                        const std::string& view, std::size_t views, const Imath::V2i& origin) {
  if (!device_) device_.emplace(device_options_);
  const std::uint64_t memory = std::min(memory_limit_, filter::usable_bytes(*device_)) / views;
  if (!denoises_additive_) available &= ~filter::additive_aovs();
  const filter::SequenceOptions options{
      .diagnostics = diagnostics_,
      .memory_limit = memory,
      .find_cuts = cuts_ == "auto" ? filter::FindCuts::yes : filter::FindCuts::no,
      .alpha = alpha_,
      .light_groups = denoises_additive_ ? light_groups : 0,
      .origin = origin};
  views_.push_back({view.empty() ? "" : ' ' + io::printable(view),
                    recipe_.make(*device_, width, height, available, options)});
  if (views_.size() == 1) matched_ = recipe_.describe_matching(available);
}

std::optional<FinishedFrame> FilterStage::run(const filter::Step& step, io::LoadedFrame noisy,
                                              Progress& progress, Profile& profile) {
  std::optional<Frame> denoised = run_view(step, noisy.frame, progress, profile, 0);
  std::vector<Frame> other_views;
  for (std::size_t view = 0; view < noisy.other_views.size(); ++view) {
    std::optional<Frame> other = run_view(step, noisy.other_views[view].frame, progress, profile, view + 1);
    if (other) other_views.push_back(std::move(*other));
  }
  if (!denoised) return std::nullopt;
  return FinishedFrame{std::move(*denoised), std::move(other_views), std::move(noisy)};
}

std::optional<Frame> FilterStage::run_view(const filter::Step& step, const Frame& frame, Progress& progress,
                                           Profile& profile, std::size_t view) {
  std::optional<Frame> denoised;
  filter::FrameReport report;
  {
    const ProfileScope scope(profile,
                             step.direction == filter::Direction::forward ? "filter" : "filter backward");
    denoised = views_[view].filter->run(step, frame, report);
  }
  const std::string name = fmt::format("frame {}{}", frame.number(), views_[view].name);
  if (!matched_.empty()) {
    progress.detail(fmt::format("device {}", device_->info().name));
    progress.detail(fmt::format("tiles {}", tiles()));
  }
  if (!matched_.empty()) progress.note(std::exchange(matched_, {}));
  profile.add(report.passes);
  if (!denoised) return denoised;
  if (report.new_shot) progress.note(fmt::format("{}: a new shot begins", name));
  if (report.non_finite_pixels > 0) {
    progress.warn(
        fmt::format("{}: {} pixels with NaN or Inf stay as they came", name, report.non_finite_pixels));
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
  return denoised;
}

void FilterStage::finish(Profile& profile) const {
  if (views_.empty()) return;
  filter::FilterMemory memory = views_.front().filter->memory();
  for (std::size_t view = 1; view < views_.size(); ++view) {
    memory.device_bytes += views_[view].filter->memory().device_bytes;
    memory.device_bytes_unaliased += views_[view].filter->memory().device_bytes_unaliased;
    memory.staging_bytes += views_[view].filter->memory().staging_bytes;
  }
  profile.set_device(device_->info().name, memory);
  check_validation(*device_);
}

}  // namespace becalm::app
