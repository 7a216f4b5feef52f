#include "filter/merge/frame_merger.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "filter/align/split_plan.h"
#include "filter/ceil_div.h"
#include "filter/for_rows.h"
#include "filter/input/host_images.h"
#include "filter/merge/carried_images.h"
#include "filter/merge/merge_chains.h"
#include "filter/tiles/host_planes.h"
#include "shaders/shared/limits.h"

namespace becalm::filter {
namespace {

using gpu::Extent;

/// Copies a tile's core into the images of the frame that are not empty.
void unpack(const MergedTile& pixels, const Tile& tile, int residual_px, MergedFrame& frame) {
  copy_core(pixels.color, tile, frame.merged.color);
  copy_core(pixels.stats, tile, frame.merged.stats);
  copy_core(pixels.warped_color, tile, frame.prediction.color);
  copy_core(pixels.warped_stats, tile, frame.prediction.stats);
  copy_core(pixels.carried, tile, frame.merged.carried);
  copy_core(pixels.warped_carried, tile, frame.prediction.carried);
  copy_core(pixels.offset, tile, frame.flow);
  copy_core(pixels.decision, tile, frame.decision);
  const Rect& core = tile.core;
  const int residual_width = ceil_div(tile.target.width, residual_px);
  frame.rejected += sum_of_rows<double>(core.height, [&](int row_of_core) {
    const int y = core.y + row_of_core;
    const int row = y - tile.target.y;
    std::size_t t = static_cast<std::size_t>(row) * tile.target.width + (core.x - tile.target.x);
    double rejected = 0.0;
    for (int x = core.x; x < core.x + core.width; ++x, ++t) {
      rejected += pixels.decision[4 * t];
      if (!frame.prediction.stats.empty()) {
        float& variance = frame.prediction.stats.at(x, y, 0);
        variance = std::min(variance + pixels.decision[4 * t + 1], kLargestVariance);
      }
      if (!frame.residual.empty()) {
        const std::size_t of_row = static_cast<std::size_t>(row / residual_px) * residual_width;
        frame.residual.at(x, y, 0) = pixels.residual[of_row + (x - tile.target.x) / residual_px];
      }
    }
    return rejected;
  });
}

}  // namespace

struct FrameMerger::Chains {
  /// For a frame that is one tile.
  Chains(gpu::Device& device, const FilterTask& task, const PyramidSplit& whole)
      : split(whole), merge(device, task, split, task.full, task.full, /*is_whole_frame=*/true) {
    merge.chain.plan();
  }

  /// For a frame that is cut into tiles of the size of `tile`.
  Chains(gpu::Device& device, const FilterTask& task, const PyramidSplit& cut, const Tile& tile)
      : split(cut),
        merge(device, task, split, tile.target.extent(), tile.source.extent(), /*is_whole_frame=*/false) {
    const Extent target = tile.target.extent();
    new_frame.emplace(device, task, split, FeatureChain::Of::new_frame, target);
    history.emplace(device, task, split, FeatureChain::Of::history, target);
    if (split.has_coarse()) coarse.emplace(device, task, split);
    for_each([](gpu::Chain& chain) { chain.plan(); });
  }

  static CutRules cut_rules(gpu::Device& device, const FilterTask& task, const PyramidSplit& split) {
    const auto of_features = [&](FeatureChain::Of of) {
      return FeatureChain(device, task, split, of, task.full).chain.tile_rules();
    };
    return {.tiles = MergeChain(device, task, split, task.full, task.full, /*is_whole_frame=*/false)
                         .chain.tile_rules(),
            .features = rules_for_both(of_features(FeatureChain::Of::new_frame),
                                       of_features(FeatureChain::Of::history))};
  }

  template <class Use>
  void for_each(const Use& use) {
    if (new_frame) use(new_frame->chain);
    if (history) use(history->chain);
    if (coarse) use(coarse->chain);
    use(merge.chain);
  }

  std::uint64_t device_bytes() {
    gpu::DeviceBytes sum;
    for_each([&](const gpu::Chain& chain) { sum += chain.device_bytes(); });
    return sum.total();
  }

  PyramidSplit split;
  MergeChain merge;
  std::optional<FeatureChain> new_frame;
  std::optional<FeatureChain> history;
  std::optional<CoarseChain> coarse;
};

struct FrameMerger::Host {
  /// Features of a whole frame.
  struct Matched {
    HostPlanes finest;  ///< level 0
    HostPlanes coarse;  ///< level `coarse` of the split
  };

  Host(const FilterTask& task, const Chains& chains)
      : history(task.full, task.carried()), next(task.full, task.carried()) {
    forget_history();
    const int planes = chains.new_frame->finest.planes;
    for (Matched* made : {&history_features, &features}) {
      made->finest = HostPlanes(level_extent(task.settings, task.full, 0).with_planes(planes));
      if (!chains.split.has_coarse()) continue;
      made->coarse =
          HostPlanes(level_extent(task.settings, task.full, chains.split.coarse).with_planes(planes));
    }
  }

  void forget_history() {
    const auto clear = [](Image& image) { std::ranges::fill(image.data(), 0.0f); };
    clear(history.color);
    clear(history.stats);
    for (Image& image : history.carried) clear(image);
    std::ranges::fill(history_features.finest.values, 0.0f);
    std::ranges::fill(history_features.coarse.values, 0.0f);
  }

  Estimate history;
  Estimate next;             ///< the next frame's history, filled tile by tile
  Matched history_features;  ///< its guide planes are the previous frame's
  Matched features;          ///< of the new frame
  Image coarse_offset;       ///< of the new frame, by the coarse chain; empty without one
};

FrameMerger::FrameMerger(gpu::Device& device, FilterTask task, std::uint64_t memory_limit)
    : task_(std::move(task)) {
  tiles_ = {uncut(task_.full)};
  chains_ = plan_whole_frame(task_, memory_limit, [&](const PyramidSplit& split) {
    return std::make_unique<Chains>(device, task_, split);
  });
  if (!chains_) {
    SplitPlan<Chains> plan = plan_split<Chains>(device, task_, memory_limit);
    chains_ = std::move(plan.chains);
    tiles_ = std::move(plan.tiles);
    feature_tiles_ = std::move(plan.feature_tiles);
    host_ = std::make_unique<Host>(task_, *chains_);
  }
  chains_->for_each([](gpu::Chain& chain) { chain.build(); });
}

FrameMerger::~FrameMerger() = default;

void FrameMerger::merge(const NewFrame& frame, MergedFrame& merged, FrameReport& report) {
  if (host_) {
    for (const Tile& tile : feature_tiles_) find_features(tile, frame, report);
    if (chains_->coarse) find_coarse_offsets(frame, report);
  }
  for (const Tile& tile : tiles_) merge_tile(tile, frame, merged, report);
  if (!host_) return;
  std::swap(host_->history, host_->next);
  std::swap(host_->history_features, host_->features);
}

void FrameMerger::upload_guide(const NewFrame& frame, const Rect& rect, std::span<float> planes) const {
  pack_guide(task_.guides.albedo ? &frame.albedo() : nullptr,
             task_.guides.normal ? &frame.frame.image(Aov::normal) : nullptr, rect, planes);
}

void FrameMerger::find_features(const Tile& tile, const NewFrame& frame, FrameReport& report) {
  const auto keep = [&](const FeatureChain& from, Host::Matched& to) {
    const auto keep_level = [&](const Features& features, std::size_t level, HostPlanes& planes) {
      const int px = level_px(task_.settings, level);
      const Extent extent = level_extent(task_.settings, tile.target.extent(), level);
      const Rect core = at_level(tile.core, px);
      copy_rect({from.chain.download<float>(features.image), extent.with_planes(features.planes)},
                within(core, at_level(tile.target, px)), planes.view(), core.x, core.y);
    };
    keep_level(from.finest, 0, to.finest);
    if (from.coarse) keep_level(*from.coarse, chains_->split.coarse, to.coarse);
    add_times(report, from.chain);
  };
  FeatureChain& new_frame = *chains_->new_frame;
  if (task_.smooths()) {
    upload(new_frame.chain, new_frame.color, view(frame.smoothed.color), tile.target);
  } else {
    pack_color(frame.frame.image(Aov::beauty), frame.finite, tile.target,
               new_frame.chain.upload<float>(new_frame.color));
  }
  new_frame.chain.upload<float>(new_frame.exposure)[0] = frame.exposure;
  if (new_frame.guide) {
    upload_guide(frame, tile.target, new_frame.chain.upload<float>(*new_frame.guide));
  }
  new_frame.chain.run();
  keep(new_frame, host_->features);

  FeatureChain& history = *chains_->history;
  upload(history.chain, history.color, view(std::as_const(host_->history.color)), tile.target);
  if (history.guide) {
    upload(history.chain, *history.guide, host_->history_features.finest.first_planes(task_.guides.planes()),
           at_level(tile.target, level_px(task_.settings, 0)));
  }
  history.chain.upload<float>(history.exposure)[0] = frame.exposure;
  history.chain.run();
  keep(history, host_->history_features);
}

void FrameMerger::find_coarse_offsets(const NewFrame& frame, FrameReport& report) {
  CoarseChain& coarse = *chains_->coarse;
  if (coarse.motion) {
    pack_motion(frame.motion, bounds(task_.full), motion_limit_px(task_.settings, task_.full),
                coarse.chain.upload<float>(*coarse.motion));
  }
  std::ranges::copy(host_->features.coarse.values, coarse.chain.upload<float>(coarse.target.image).begin());
  std::ranges::copy(host_->history_features.coarse.values,
                    coarse.chain.upload<float>(coarse.source.image).begin());
  coarse.chain.run();
  add_times(report, coarse.chain);
  host_->coarse_offset = download_offset(coarse, task_, chains_->split);
}

void FrameMerger::upload_cut(const Tile& tile) {
  MergeChain& merge = chains_->merge;
  gpu::Chain& chain = merge.chain;
  const MergeChain::Cut& cut = *merge.cut;
  upload_origin(chain, cut.target_origin, tile.target, tile.source);
  const int finest_px = level_px(task_.settings, 0);
  upload(chain, cut.target.image, std::as_const(host_->features.finest).view(),
         at_level(tile.target, finest_px));
  upload(chain, cut.source.image, std::as_const(host_->history_features.finest).view(),
         at_level(tile.source, finest_px));
  if (cut.start) upload_start(chain, *cut.start, host_->coarse_offset, task_, chains_->split, tile.target);
  upload(chain, merge.color.previous, view(std::as_const(host_->history.color)), tile.source);
  upload(chain, merge.stats.previous, view(std::as_const(host_->history.stats)), tile.source);
  for (std::size_t i = 0; i < merge.carried.size(); ++i) {
    upload(chain, merge.carried[i].previous, view(std::as_const(host_->history.carried[i])), tile.source);
  }
}

void FrameMerger::merge_tile(const Tile& tile, const NewFrame& frame, MergedFrame& merged,
                             FrameReport& report) {
  MergeChain& merge = chains_->merge;
  gpu::Chain& chain = merge.chain;
  merge.noisy.upload(chain, task_, frame, tile, report);
  if (task_.smooths()) {
    upload(chain, merge.smoothed_color, view(frame.smoothed.color), tile.target);
    upload(chain, merge.smoothed_stats, view(frame.smoothed.stats), tile.target);
  }
  upload_carried(chain, merge.additive, frame.merged_additive(), tile.target);
  if (merge.motion) {
    pack_motion(frame.motion, tile.target, motion_limit_px(task_.settings, task_.full),
                chain.upload<float>(*merge.motion));
  }
  if (merge.guide) {
    upload_guide(frame, tile.target, chain.upload<float>(*merge.guide));
  }
  if (host_) upload_cut(tile);
  chain.run();
  add_times(report, chain);

  const MergedTile pixels = merge.download();
  unpack(pixels, tile, level_px(task_.settings, 0), merged);
  if (!host_) return;
  copy_core(pixels.color, tile, host_->next.color);
  copy_core(pixels.stats, tile, host_->next.stats);
  copy_core(pixels.carried, tile, host_->next.carried);
}

void FrameMerger::reset() {
  if (host_) {
    host_->forget_history();
  } else {
    chains_->merge.chain.reset_history();
  }
}

FilterMemory FrameMerger::memory() const {
  FilterMemory memory{
      .tiles = tiles_.size(), .tile = tiles_.front().target.extent(), .tile_plan = describe(tiles_)};
  chains_->for_each([&](const gpu::Chain& chain) { add_memory(memory, chain); });
  return memory;
}

}  // namespace becalm::filter
