#include "filter/stereo/stereo_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "filter/align/pair_aligner.h"
#include "filter/align/pyramid.h"
#include "filter/ceil_div.h"
#include "filter/for_rows.h"
#include "filter/sequence/sequence_filter.h"
#include "filter/stereo/disparity.h"
#include "filter/stereo/eye_combiner.h"

namespace becalm::filter {
namespace {

/// The eyes are searched for in means of so many pixels squared: offsets between eyes change slowly but at
/// edges, where both eyes see different things.
constexpr int kSearchScale = 4;
constexpr int kLeastSearchSide = 64;  ///< frames of less are searched as they are

/// The combination of the eyes may take 1 / kShareOfEyes of the memory.
constexpr std::uint64_t kShareOfEyes = 4;

Settings search_settings(Settings settings) {
  settings.match_downsample = 1;
  settings.pyramid = {};
  settings.blur_radius = {1, 2};
  settings.distance = Distance::log_l1_centered;
  settings.refine_levels = 12;
  settings.prefilter = 0;
  settings.motion = MotionUse::guide;  // that of the depth
  return settings;
}

/// The frame as it is searched: the mean colours of the estimate, AOVs of the frame, and as its motion the
/// offset that its depth tells.
Frame small_frame(const Frame& frame, const Estimate& estimate, const Image& expected, const AovSet& guides,
                  int scale) {
  Image beauty = block_means(estimate.color, scale);
  Frame small(frame.number(), beauty.width(), beauty.height());
  small.image(Aov::beauty) = std::move(beauty);
  for (const Aov aov : {Aov::albedo, Aov::normal}) {
    if (contains(guides, aov)) small.image(aov) = block_means(frame.image(aov), scale);
  }
  if (!contains(guides, Aov::motion)) return small;
  Image& motion = small.add(Aov::motion);
  for_rows(small.height(), [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < small.width(); ++x) {
        // The middle of the block; means would mix surfaces.
        const int u = std::min(x * scale + scale / 2, frame.width() - 1);
        const int v = std::min(y * scale + scale / 2, frame.height() - 1);
        const float offset = expected.at(u, v, 0);
        const bool known = std::abs(offset) < 1e6f;
        motion.at(x, y, 0) =
            known ? offset / static_cast<float>(scale) : std::numeric_limits<float>::quiet_NaN();
      }
    }
  });
  return small;
}

}  // namespace

struct StereoFilter::State {
  Image candidates(const EyeFrame& own, const Image& expected, const Frame& small_own,
                   const Frame& small_other, FrameReport& report);

  std::vector<SequenceFilter> eyes;
  int scale = 1;          ///< of the frame over what is searched
  float limit_px = 0.0f;  ///< of the offsets that depths tell
  AovSet guides;          ///< of what is searched
  std::optional<PairAligner> aligner;
  std::optional<EyeCombiner> combiner;
};

StereoFilter::StereoFilter(gpu::Device& device, const Settings& settings, int width, int height,
                           AovSet available, const SequenceOptions& options)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  const std::uint64_t all = std::min(options.memory_limit, usable_bytes(device));
  SequenceOptions of_eye = options;
  of_eye.memory_limit = (all - all / kShareOfEyes) / 2;
  for (int eye = 0; eye < 2; ++eye) s.eyes.emplace_back(device, settings, width, height, available, of_eye);
  const FilterTask& task = s.eyes.front().task();
  s.scale = std::min(width, height) >= kLeastSearchSide ? kSearchScale : 1;
  const Settings search = search_settings(settings);
  s.limit_px = motion_limit_px(search, {width, height});
  const bool has_depth = contains(task.used, Aov::depth);
  for (const Aov aov : {Aov::albedo, Aov::normal}) {
    s.guides.set(static_cast<std::size_t>(aov), contains(task.used, aov));
  }
  s.guides.set(static_cast<std::size_t>(Aov::motion), has_depth);
  const gpu::Extent small{ceil_div(width, s.scale), ceil_div(height, s.scale)};
  const std::size_t levels = pyramid_extents(search, small.width, small.height).size();
  const int limit_of_small = ceil_div(static_cast<int>(std::ceil(s.limit_px)), s.scale);
  s.aligner.emplace(device, search, small.width, small.height, s.guides);
  s.combiner.emplace(device, task, s.scale * offset_limit_px(search, {0, levels}, 0, limit_of_small),
                     all / kShareOfEyes);
}
StereoFilter::~StereoFilter() = default;
StereoFilter::StereoFilter(StereoFilter&&) noexcept = default;

Image StereoFilter::State::candidates(const EyeFrame& own, const Image& expected, const Frame& small_own,
                                      const Frame& small_other, FrameReport& report) {
  const PairAlignment found = aligner->align(small_own, small_other);
  for (const gpu::PassTime& pass : found.passes) report.passes.push_back(pass);
  const Frame& frame = own.frame.frame;
  const Image offsets = upsampled_offsets(found.offset, scale, frame.width(), frame.height());
  Image candidates(frame.width(), frame.height(), 4);
  for_rows(frame.height(), [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < frame.width(); ++x) {
        const std::span<float> pixel = candidates.pixel(x, y);
        std::ranges::copy(offsets.pixel(x, y), pixel.begin());
        if (!expected.empty()) std::ranges::copy(expected.pixel(x, y), pixel.begin() + 2);
      }
    }
  });
  return candidates;
}

StereoFilter::Pair<std::optional<Frame>> StereoFilter::run(const Step& step, const Pair<const Frame*>& eyes,
                                                           Pair<FrameReport>& reports) {
  State& s = *state_;
  std::vector<std::optional<SequenceFilter::Merged>> merged;
  for (std::size_t eye = 0; eye < 2; ++eye)
    merged.push_back(s.eyes[eye].begin(step, *eyes[eye], reports[eye]));
  if (!merged[0]) return {};
  const FilterTask& task = s.eyes[0].task();
  Pair<Image> expected;
  std::vector<EyeFrame> own;
  std::vector<Frame> small;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    if (contains(task.used, Aov::depth)) expected[eye] = expected_in_other(*eyes[eye], s.limit_px);
    own.push_back({merged[eye]->frame, merged[eye]->made.merged});
    small.push_back(small_frame(*eyes[eye], own[eye].estimate, expected[eye], s.guides, s.scale));
  }
  Pair<Estimate> combined;
  Pair<Image> weights;
  const bool wants_weight = contains(task.diagnostics, Aov::gain);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const std::size_t other = 1 - eye;
    if (wants_weight) weights[eye] = Image(task.full.width, task.full.height, 1);
    const Image candidates = s.candidates(own[eye], expected[eye], small[eye], small[other], reports[eye]);
    combined[eye] = s.combiner->run(own[eye], own[other], candidates, weights[eye], reports[eye]);
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
  const auto add = [&](const FilterMemory& part) {
    memory.device_bytes += part.device_bytes;
    memory.device_bytes_unaliased += part.device_bytes_unaliased;
    memory.staging_bytes += part.staging_bytes;
  };
  add(s.eyes[1].memory());
  const FilterMemory eyes = s.combiner->memory();
  add(eyes);
  memory.device_bytes += s.aligner->device_bytes();
  memory.device_bytes_unaliased += s.aligner->device_bytes_unaliased();
  if (eyes.tiles > 1) {
    memory.tile_plan =
        fmt::format("{}eyes {}", memory.tile_plan == "1" ? "" : memory.tile_plan + "; ", eyes.tile_plan);
  }
  return memory;
}

}  // namespace becalm::filter
