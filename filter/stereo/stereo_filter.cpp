#include "filter/stereo/stereo_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "filter/align/pair_aligner.h"
#include "filter/align/pyramid.h"
#include "filter/sequence/sequence_filter.h"
#include "filter/stereo/disparity.h"
#include "filter/stereo/eye_combiner.h"
#include "filter/tiles/build_within.h"
#include "frame/error.h"

namespace becalm::filter {
namespace {

/// Eyes are searched at full size: their offsets are a few pixels, and those found at half the size blur more
/// than the other eye's samples gain.
Settings search_settings(Settings settings) {
  settings.match_downsample = 1;
  settings.pyramid = {};
  settings.blur_radius = {1, 2};
  settings.distance = Distance::log_l1_centered;
  settings.refine_levels = 12;
  settings.motion = MotionUse::none;
  return settings;
}

/// The frame as it is searched: the estimate's colours, and albedo and normal where they are matched.
Frame searched(const Frame& frame, const Estimate& estimate, const AovSet& used) {
  Frame result(frame.number(), frame.width(), frame.height());
  result.image(Aov::beauty) = estimate.color;
  for (const Aov aov : {Aov::albedo, Aov::normal}) {
    if (contains(used, aov)) result.image(aov) = frame.image(aov);
  }
  return result;
}

}  // namespace

struct StereoFilter::State {
  void make_aligner();
  Pair<Correspondence> find(const Pair<const Frame*>& eyes, const std::vector<EyeFrame>& own,
                            Pair<FrameReport>& reports);

  gpu::Device& device;
  std::uint64_t scratch_limit = 0;  ///< bytes that the eyes leave
  std::vector<SequenceFilter> eyes = {};
  float depth_limit_px = 0.0f;  ///< of the offsets that depths tell
  std::optional<EyeCombiner> combiner = {};
  /// Without depth; with it from the first pair on whose cameras are not known.
  std::optional<PairAligner> aligner = {};
};

StereoFilter::StereoFilter(gpu::Device& device, const Settings& settings, int width, int height,
                           AovSet available, const SequenceOptions& options)
    : state_(std::make_unique<State>(State{.device = device})) {
  State& s = *state_;
  const std::uint64_t all = std::min(options.memory_limit, usable_bytes(device));
  SequenceOptions of_eye = options;
  of_eye.memory_limit = all / 2;
  s.scratch_limit = all;
  for (int eye = 0; eye < 2; ++eye) {
    s.eyes.emplace_back(device, settings, width, height, available, of_eye);
    s.scratch_limit -= s.eyes.back().memory().device.own;
  }
  const Settings search = search_settings(settings);
  Settings known = search;
  known.motion = MotionUse::guide;
  s.depth_limit_px = motion_limit_px(known, {width, height});
  const int of_search = offset_limit_px(search, {0, pyramid_extents(search, width, height).size()});
  const int limit_px = std::max(static_cast<int>(std::ceil(s.depth_limit_px)), of_search);
  build_within(s.scratch_limit, [&](std::uint64_t limit) {
    s.combiner.emplace(device, s.eyes.front().task(), limit_px, limit);
  });
  if (!contains(s.eyes.front().task().used, Aov::depth)) s.make_aligner();
}
StereoFilter::~StereoFilter() = default;
StereoFilter::StereoFilter(StereoFilter&&) noexcept = default;

void StereoFilter::State::make_aligner() {
  const FilterTask& task = eyes.front().task();
  build_within(scratch_limit, [&](std::uint64_t limit) {
    aligner.emplace(device, search_settings(task.settings), task.full.width, task.full.height, task.used,
                    limit);
  });
}

StereoFilter::Pair<Correspondence> StereoFilter::State::find(const Pair<const Frame*>& frames,
                                                             const std::vector<EyeFrame>& own,
                                                             Pair<FrameReport>& reports) {
  const FilterTask& task = eyes.front().task();
  const bool has_depth = contains(task.used, Aov::depth);
  if (has_depth && frames[0]->stereo() && frames[1]->stereo()) {
    if (frames[0]->stereo()->eye == frames[1]->stereo()->eye) {
      throw Error(
          ExitStatus::bad_input,
          fmt::format("frame {}: both views are of one eye, as they say themselves", frames[0]->number()));
    }
    return {correspondence_by_depth(*frames[0], depth_limit_px),
            correspondence_by_depth(*frames[1], depth_limit_px)};
  }
  if (!aligner) make_aligner();
  const Pair<Frame> images{searched(*frames[0], own[0].estimate, task.used),
                           searched(*frames[1], own[1].estimate, task.used)};
  const PairAlignment found = aligner->align(images[0], images[1], reports[0]);
  Pair<Image> offsets = unique_offsets(found.offset, found.residual);
  Pair<Correspondence> where;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    where[eye].offset = std::move(offsets[eye]);
    // A surface is about as far from either eye.
    if (has_depth) where[eye].depth = frames[eye]->image(Aov::depth);
  }
  return where;
}

StereoFilter::Pair<std::optional<Frame>> StereoFilter::run(const Step& step, const Pair<const Frame*>& eyes,
                                                           Pair<FrameReport>& reports) {
  State& s = *state_;
  std::vector<std::optional<SequenceFilter::Merged>> merged;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    merged.push_back(s.eyes[eye].begin(step, *eyes[eye], reports[eye]));
  }
  if (!merged[0]) return {};
  std::vector<EyeFrame> own;
  own.reserve(merged.size());
  for (auto& eye : merged) own.push_back({eye->frame, eye->made.merged});
  const Pair<Correspondence> where = s.find(eyes, own, reports);
  const FilterTask& task = s.eyes[0].task();
  const bool wants_weight = contains(task.diagnostics, Aov::stereo_weight);
  Pair<Estimate> combined;
  Pair<Image> weights;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    if (wants_weight) weights[eye] = Image(task.full.width, task.full.height, 1);
    combined[eye] = s.combiner->run(own[eye], own[1 - eye], where[eye], weights[eye], reports[eye]);
  }
  Pair<std::optional<Frame>> results;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    merged[eye]->made.merged = std::move(combined[eye]);
    results[eye] = s.eyes[eye].finish(*merged[eye], reports[eye]);
    if (wants_weight) results[eye]->image(Aov::stereo_weight) = std::move(weights[eye]);
  }
  return results;
}

FilterMemory StereoFilter::memory() const {
  const State& s = *state_;
  FilterMemory memory = s.eyes[0].memory();
  memory += s.eyes[1].memory();  // which is cut alike
  add_memory(memory, s.combiner->memory(), "eyes");
  if (s.aligner) add_memory(memory, s.aligner->memory(), "search");
  return memory;
}

}  // namespace becalm::filter
