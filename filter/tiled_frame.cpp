#include "filter/tiled_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "filter/additive.h"
#include "filter/ceil_div.h"
#include "filter/host_images.h"
#include "filter/merge.h"
#include "frame/error.h"

namespace becalm::filter {
namespace {

using gpu::Extent;
using gpu::ImageId;

/// The pixels of a level that cover a rectangle which begins at the level's multiples.
Rect at_level(const Rect& rect, int px) {
  return {rect.x / px, rect.y / px, ceil_div(rect.width, px), ceil_div(rect.height, px)};
}

/// The first planes of an image.
PixelView<const float> first_planes(const HostPlanes& image, int planes) {
  const Extent extent = image.extent.with_planes(planes);
  return {std::span(image.values).first(extent.elements()), extent};
}

}  // namespace

struct TiledFrame::Chains {
  Chains(gpu::Device& device, const FilterTask& task, const PyramidSplit& split, const Tile& tile)
      : new_frame(device, task, split, FeatureChain::Of::new_frame, tile.target.extent()) {
    if (task.settings.weight_radiance > 0.0f) {
      history.emplace(device, task, split, FeatureChain::Of::history, tile.target.extent());
    }
    const int planes = new_frame.finest.planes;
    if (split.has_coarse()) coarse.emplace(device, task, split, planes);
    this->tile.emplace(device, task, split, planes, tile.target.extent(), tile.source.extent());
  }

  template <class Use>
  void for_each(const Use& use) {
    use(new_frame.chain);
    if (history) use(history->chain);
    if (coarse) use(coarse->chain);
    use(tile->chain);
  }

  std::uint64_t device_bytes() {
    std::uint64_t sum = 0;
    for_each([&](const gpu::Chain& chain) { sum += chain.device_bytes(); });
    return sum;
  }

  FeatureChain new_frame;
  std::optional<FeatureChain> history;  ///< none if radiance is not matched: its guides are there already
  std::optional<CoarseChain> coarse;
  std::optional<TileChain> tile;
};

TiledFrame::TiledFrame(gpu::Device& device, FilterTask task, std::uint64_t memory_limit)
    : task_(std::move(task)) {
  plan(device, memory_limit);
  chains_->for_each([](gpu::Chain& chain) { chain.build(); });

  const int planes = chains_->tile->target.planes;
  for (HostFeatures* features : {&history_.features, &features_}) {
    features->finest = HostPlanes(level_extent(task_.settings, task_.full, 0).with_planes(planes));
    if (!split_.has_coarse()) continue;
    features->coarse =
        HostPlanes(level_extent(task_.settings, task_.full, split_.coarse).with_planes(planes));
  }
  history_.estimate = Estimate(task_.full, task_.carried());
  merged_ = Estimate(task_.full, task_.carried());
  if (chains_->tile->albedo) history_.albedo = albedo_ = Image(task_.full.width, task_.full.height, 4);
}

TiledFrame::~TiledFrame() = default;

void TiledFrame::plan(gpu::Device& device, std::uint64_t memory_limit) {
  const Settings& settings = task_.settings;
  const Extent full = task_.full;
  const std::size_t levels = pyramid_extents(settings, full.width, full.height).size();
  std::uint64_t least_work = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t least_bytes = std::numeric_limits<std::uint64_t>::max();
  std::string reason;
  for (std::size_t coarse = 1; coarse <= levels; ++coarse) {
    const PyramidSplit split{.levels = levels, .coarse = coarse};
    TileRules rules = search_tile_rules(settings, device.info(), levels, coarse, merge_margin_px(settings));
    if (contains(task_.used, Aov::motion)) rules.reach = reach_of_motion_px(settings, full, levels);
    rules.reach += resample_margin_px(settings);
    const TileRules feature_rules = local_tile_rules(feature_margin_px(settings), rules.core_grid);
    std::unique_ptr<Chains> chains;
    std::vector<Tile> feature_tiles;
    const auto fits = [&](const Tile& tile) {
      try {
        chains = std::make_unique<Chains>(device, task_, split, tile);
      } catch (const gpu::DeviceLimitError& error) {
        if (reason.empty()) reason = error.what();
        return false;
      }
      feature_tiles = cut_tiles(full, tile.target.extent(), feature_rules);
      if (feature_tiles.empty()) {
        if (reason.empty()) reason = "the prefilter reaches further than tiles have room for";
        return false;
      }
      const std::uint64_t bytes = chains->device_bytes();
      if (bytes < least_bytes) {
        least_bytes = bytes;
        reason = tiles_too_large(tile, bytes, memory_limit);
      }
      return bytes <= memory_limit;
    };
    std::vector<Tile> tiles = plan_tiles(full, rules, fits);
    if (tiles.empty()) continue;
    const std::uint64_t work = tiles.size() * tiles.front().target.extent().elements();
    if (work >= least_work) continue;
    least_work = work;
    split_ = split;
    chains_ = std::move(chains);
    feature_tiles_ = std::move(feature_tiles);
    tiles_ = std::move(tiles);
  }
  if (tiles_.empty()) throw cannot_be_cut(full, reason);
}

void TiledFrame::merge(const NewFrame& frame, MergedFrame& merged, FrameReport& report) {
  for (const Tile& tile : feature_tiles_) find_features(tile, frame, report);
  if (chains_->coarse) find_coarse_offsets(frame, report);
  if (chains_->tile->albedo) {
    pack_albedo(frame.frame.image(Aov::albedo), bounds(task_.full), albedo_.data());
  }
  for (const Tile& tile : tiles_) merge_tile(tile, frame, merged, report);
  std::swap(history_.estimate, merged_);
  std::swap(history_.features, features_);
  std::swap(history_.albedo, albedo_);
}

void TiledFrame::find_features(const Tile& tile, const NewFrame& frame, FrameReport& report) {
  const auto keep = [&](const FeatureChain& from, HostFeatures& to) {
    const auto keep_level = [&](const Features& features, std::size_t level, HostPlanes& planes) {
      const int px = level_px(task_.settings, level);
      const Extent extent = level_extent(task_.settings, tile.target.extent(), level);
      const Rect core = at_level(tile.core, px);
      copy_rect({from.chain.download<float>(features.image), extent.with_planes(features.planes)},
                within(core, at_level(tile.target, px)), planes.view(), core.x, core.y);
    };
    keep_level(from.finest, 0, to.finest);
    if (from.coarse) keep_level(*from.coarse, split_.coarse, to.coarse);
    add_times(report, from.chain);
  };
  FeatureChain& new_frame = chains_->new_frame;
  if (task_.smooths()) {
    upload(new_frame.chain, new_frame.color, view(frame.smoothed.color), tile.target);
  } else {
    pack_color(frame.frame.image(Aov::beauty), frame.finite, tile.target,
               new_frame.chain.upload<float>(new_frame.color));
  }
  new_frame.chain.upload<float>(new_frame.exposure)[0] = frame.exposure;
  if (new_frame.guide) {
    pack_guide(frame.frame, task_.guides.albedo, task_.guides.normal, tile.target,
               new_frame.chain.upload<float>(*new_frame.guide));
  }
  new_frame.chain.run();
  keep(new_frame, features_);
  if (!chains_->history) return;
  FeatureChain& history = *chains_->history;
  upload(history.chain, history.color, view(std::as_const(history_.estimate.color)), tile.target);
  if (history.guide) {
    upload(history.chain, *history.guide, first_planes(history_.features.finest, task_.guides.planes()),
           at_level(tile.target, level_px(task_.settings, 0)));
  }
  history.chain.upload<float>(history.exposure)[0] = frame.exposure;
  history.chain.run();
  keep(history, history_.features);
}

void TiledFrame::find_coarse_offsets(const NewFrame& frame, FrameReport& report) {
  CoarseChain& coarse = *chains_->coarse;
  if (coarse.motion) {
    pack_motion(frame.frame.image(Aov::motion), bounds(task_.full),
                motion_limit_px(task_.settings, task_.full), coarse.chain.upload<float>(*coarse.motion));
  }
  std::ranges::copy(features_.coarse.values, coarse.chain.upload<float>(coarse.target.image).begin());
  std::ranges::copy(history_.features.coarse.values, coarse.chain.upload<float>(coarse.source.image).begin());
  coarse.chain.run();
  add_times(report, coarse.chain);
}

void TiledFrame::merge_tile(const Tile& tile, const NewFrame& frame, MergedFrame& merged,
                            FrameReport& report) {
  TileChain& chains = *chains_->tile;
  gpu::Chain& chain = chains.chain;
  const int finest_px = level_px(task_.settings, 0);
  chains.noisy.upload(chain, task_, frame, tile, report);
  if (task_.smooths()) {
    upload(chain, chains.smoothed_color, view(frame.smoothed.color), tile.target);
    upload(chain, chains.smoothed_stats, view(frame.smoothed.stats), tile.target);
  }
  if (chains.motion) {
    pack_motion(frame.frame.image(Aov::motion), tile.target, motion_limit_px(task_.settings, task_.full),
                chain.upload<float>(*chains.motion));
  }
  const auto origin = chain.upload<float>(chains.target_origin);
  origin[0] = static_cast<float>(tile.target.x - tile.source.x);
  origin[1] = static_cast<float>(tile.target.y - tile.source.y);
  if (chains.albedo) {
    upload(chain, chains.albedo->current, view(std::as_const(albedo_)), tile.target);
    upload(chain, chains.albedo->previous, view(std::as_const(history_.albedo)), tile.source);
  }
  upload(chain, chains.history_color, view(std::as_const(history_.estimate.color)), tile.source);
  upload(chain, chains.history_stats, view(std::as_const(history_.estimate.stats)), tile.source);
  upload_additive(chain, chains.additive, frame.merged_additive(), tile.target);
  upload_additive(chain, chains.history_additive, history_.estimate.additive, tile.source);
  upload(chain, chains.target.image, std::as_const(features_.finest).view(),
         at_level(tile.target, finest_px));
  upload(chain, chains.source.image, std::as_const(history_.features.finest).view(),
         at_level(tile.source, finest_px));
  if (chains.start) {
    const CoarseChain& coarse = *chains_->coarse;
    const Extent extent = level_extent(task_.settings, task_.full, split_.coarse);
    upload(chain, *chains.start, {coarse.chain.download<float>(coarse.offset), extent, 2},
           at_level(tile.target, level_px(task_.settings, split_.coarse)));
  }
  chain.run();
  add_times(report, chain);

  const MergedTile images = download(chain, task_, chains.merged);
  unpack(images, tile, merged);
  copy_core(images.color, tile, merged_.color);
  copy_core(images.stats, tile, merged_.stats);
  copy_core(images.additive, tile, merged_.additive);
}

void TiledFrame::reset() {
  for (Image& image : history_.estimate.additive) std::ranges::fill(image.data(), 0.0f);
  for (const auto values : {history_.estimate.color.data(), history_.estimate.stats.data(),
                            std::span<float>(history_.features.finest.values),
                            std::span<float>(history_.features.coarse.values)}) {
    std::ranges::fill(values, 0.0f);
  }
}

FilterMemory TiledFrame::memory() const {
  FilterMemory memory{.tiles = tiles_.size(), .tile = tiles_.front().target.extent()};
  chains_->for_each([&](const gpu::Chain& chain) { add_memory(memory, chain); });
  return memory;
}

}  // namespace becalm::filter
