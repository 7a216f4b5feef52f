#include "filter/align/pair_aligner.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "filter/align/pair_search.h"
#include "filter/align/split_plan.h"
#include "filter/input/frame_check.h"
#include "filter/input/host_images.h"
#include "filter/tiles/host_planes.h"
#include "filter/tiles/pixel_view.h"

namespace becalm::filter {
namespace {

using gpu::Extent;
using gpu::ImageId;

/// One of the two frames, whose rectangles are uploaded.
struct MatchedFrame {
  explicit MatchedFrame(const Frame& of) : frame(of), finite(finite_pixels(of.image(Aov::beauty))) {}

  /// `Inputs` has the images `color` and `guide`.
  template <class Inputs>
  void upload(gpu::Chain& chain, const Guides& guides, const Inputs& inputs, const Rect& rect) const {
    pack_color(frame.image(Aov::beauty), finite, rect, chain.upload<float>(inputs.color));
    if (inputs.guide) {
      pack_guide(guides.albedo ? &frame.image(Aov::albedo) : nullptr,
                 guides.normal ? &frame.image(Aov::normal) : nullptr, rect,
                 chain.upload<float>(*inputs.guide));
    }
  }

  const Frame& frame;
  std::vector<std::uint8_t> finite;
};

struct MatchedPair {
  MatchedFrame target;
  MatchedFrame source;
  float exposure;  ///< of the target, for both
};

}  // namespace

/// The chains for tiles of one size.
struct PairAligner::Chains {
  Chains(gpu::Device& device, const FilterTask& task, const PyramidSplit& split_, const Tile& tile)
      : split(split_), search(device, task, split, tile.target.extent(), tile.source.extent()) {
    if (split.has_coarse()) {
      features.emplace(features_of(device, task, split, tile.target.extent()));
      coarse.emplace(device, task, split);
    }
    for_each(*this, [](gpu::Chain& chain) { chain.plan(); });
  }

  static CutRules cut_rules(gpu::Device& device, const FilterTask& task, const PyramidSplit& split) {
    CutRules rules{.tiles = PairSearch(device, task, split, task.full, task.full).chain.tile_rules(),
                   .features = {}};
    if (split.has_coarse()) rules.features = features_of(device, task, split, task.full).chain.tile_rules();
    return rules;
  }

  static FeatureChain features_of(gpu::Device& device, const FilterTask& task, const PyramidSplit& split,
                                  Extent part) {
    return {device, task, split, FeatureChain::Of::new_frame, part, FeatureChain::Outputs::coarse};
  }

  template <class Self, class Use>
  static void for_each(Self& self, const Use& use) {
    if (self.features) use(self.features->chain);
    if (self.coarse) use(self.coarse->chain);
    use(self.search.chain);
  }

  std::uint64_t device_bytes() const {
    gpu::DeviceBytes sum;
    for_each(*this, [&](const gpu::Chain& chain) { sum += chain.device_bytes(); });
    return sum.total();
  }

  PyramidSplit split;
  std::optional<FeatureChain> features;  ///< of either frame, at level `coarse` of the split
  std::optional<CoarseChain> coarse;
  PairSearch search;
};

struct PairAligner::State {
  State(gpu::Device& device, const Settings& settings, Extent full, const AovSet& available,
        std::uint64_t memory_limit);

  void check(const Frame& target, const Frame& source) const;
  void find_coarse_offsets(const MatchedPair& pair, FrameReport& report);
  /// Makes the coarse features of a frame, tile by tile.
  HostPlanes find_coarse_features(const MatchedFrame& frame, float exposure, FrameReport& report);
  void search_tile(const Tile& tile, const MatchedPair& pair, PairAlignment& result, FrameReport& report);

  FilterTask task;
  SplitPlan<Chains> plan;
  Image coarse_offset;  ///< of the pair at work; empty without a coarse chain
};

PairAligner::State::State(gpu::Device& device, const Settings& settings, Extent full, const AovSet& available,
                          std::uint64_t memory_limit)
    : task{.settings = settings,
           .full = full,
           .used = available,
           .diagnostics = {},
           .guides = guides_of(settings, available)} {
  task.used.reset(static_cast<std::size_t>(Aov::motion));
  plan.tiles = {uncut(task.full)};
  plan.chains = plan_whole_frame(task, memory_limit, [&](const PyramidSplit& split) {
    return std::make_unique<Chains>(device, task, split, plan.tiles.front());
  });
  if (!plan.chains) plan = plan_split<Chains>(device, task, memory_limit);
  Chains::for_each(*plan.chains, [](gpu::Chain& chain) { chain.build(); });
}

void PairAligner::State::check(const Frame& target, const Frame& source) const {
  AovSet matched;
  matched.set(static_cast<std::size_t>(Aov::beauty));
  matched.set(static_cast<std::size_t>(Aov::albedo), task.guides.albedo);
  matched.set(static_cast<std::size_t>(Aov::normal), task.guides.normal);
  for (const Frame* frame : {&target, &source}) {
    check_frame(*frame, task.full.width, task.full.height, matched, "the aligner's frames");
  }
}

HostPlanes PairAligner::State::find_coarse_features(const MatchedFrame& frame, float exposure,
                                                    FrameReport& report) {
  FeatureChain& features = *plan.chains->features;
  const std::size_t level = plan.chains->split.coarse;
  const int px = level_px(task.settings, level);
  const auto extent_of = [&](Extent full) {
    return level_extent(task.settings, full, level).with_planes(features.coarse->planes);
  };
  HostPlanes found(extent_of(task.full));
  for (const Tile& tile : plan.feature_tiles) {
    features.chain.upload<float>(features.exposure)[0] = exposure;
    frame.upload(features.chain, task.guides, features, tile.target);
    features.chain.run();
    add_times(report, features.chain);
    const Rect core = at_level(tile.core, px);
    copy_rect({features.chain.download<float>(features.coarse->image), extent_of(tile.target.extent())},
              within(core, at_level(tile.target, px)), found.view(), core.x, core.y);
  }
  return found;
}

void PairAligner::State::find_coarse_offsets(const MatchedPair& pair, FrameReport& report) {
  const HostPlanes target = find_coarse_features(pair.target, pair.exposure, report);
  const HostPlanes source = find_coarse_features(pair.source, pair.exposure, report);
  CoarseChain& coarse = *plan.chains->coarse;
  std::ranges::copy(target.values, coarse.chain.upload<float>(coarse.target.image).begin());
  std::ranges::copy(source.values, coarse.chain.upload<float>(coarse.source.image).begin());
  coarse.chain.run();
  add_times(report, coarse.chain);
  coarse_offset = download_offset(coarse, task, plan.chains->split);
}

void PairAligner::State::search_tile(const Tile& tile, const MatchedPair& pair, PairAlignment& result,
                                     FrameReport& report) {
  PairSearch& search = plan.chains->search;
  gpu::Chain& chain = search.chain;
  chain.upload<float>(search.exposure)[0] = pair.exposure;
  upload_origin(chain, search.target_origin, tile.target, tile.source);
  pair.target.upload(chain, task.guides, search.target, tile.target);
  pair.source.upload(chain, task.guides, search.source, tile.source);
  if (search.start) {
    upload_start(chain, *search.start, coarse_offset, task, plan.chains->split, tile.target);
  }
  chain.run();
  add_times(report, chain);
  copy_core(chain.download<float>(search.offset), tile, result.offset);
  const int px = level_px(task.settings, 0);
  const Rect core = at_level(tile.core, px);
  copy_rect({chain.download<float>(search.residual), level_extent(task.settings, tile.target.extent(), 0)},
            within(core, at_level(tile.target, px)), view(result.residual), core.x, core.y);
}

PairAligner::PairAligner(gpu::Device& device, const Settings& settings, int width, int height,
                         const AovSet& available, std::uint64_t memory_limit)
    : state_(std::make_unique<State>(device, settings, Extent{width, height}, available, memory_limit)) {}
PairAligner::~PairAligner() = default;
PairAligner::PairAligner(PairAligner&&) noexcept = default;

PairAlignment PairAligner::align(const Frame& target, const Frame& source, FrameReport& report) {
  State& s = *state_;
  s.check(target, source);
  const MatchedPair pair{.target = MatchedFrame(target),
                         .source = MatchedFrame(source),
                         .exposure = exposure(target.image(Aov::beauty))};
  if (s.plan.chains->coarse) s.find_coarse_offsets(pair, report);
  const Extent full = s.task.full;
  const Extent matched = level_extent(s.task.settings, full, 0);
  PairAlignment result{Image(full.width, full.height, 2), Image(matched.width, matched.height, 1)};
  for (const Tile& tile : s.plan.tiles) s.search_tile(tile, pair, result, report);
  return result;
}

FilterMemory PairAligner::memory() const {
  const SplitPlan<Chains>& plan = state_->plan;
  FilterMemory memory{.tiles = plan.tiles.size(),
                      .tile = plan.tiles.front().target.extent(),
                      .tile_plan = describe(plan.tiles)};
  Chains::for_each(std::as_const(*plan.chains), [&](const gpu::Chain& chain) { add_memory(memory, chain); });
  return memory;
}

}  // namespace becalm::filter
