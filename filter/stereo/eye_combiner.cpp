#include "filter/stereo/eye_combiner.h"

#include <string>

#include "filter/merge/additive.h"
#include "filter/tiles/pixel_view.h"

namespace becalm::filter {

EyeCombiner::EyeCombiner(gpu::Device& device, const FilterTask& task, int limit_px,
                         std::uint64_t memory_limit)
    : task_(task) {
  const auto make = [&](gpu::Extent target, gpu::Extent source) {
    return std::make_unique<EyePasses>(device, task_, limit_px, target, source);
  };
  std::string reason;
  const TileRules rules = make(task_.full, task_.full)->chain.tile_rules();
  tiles_ = plan_tiles(task_.full, rules, [&](const Tile& tile) {
    passes_ = make(tile.target.extent(), tile.source.extent());
    try {
      passes_->chain.plan();
    } catch (const gpu::DeviceLimitError& error) {
      reason = error.what();
      return false;
    }
    const std::uint64_t bytes = passes_->chain.device_bytes();
    reason = tiles_too_large(tile, bytes, memory_limit);
    return bytes <= memory_limit;
  });
  if (tiles_.empty()) throw cannot_be_cut(task_.full, reason);
  passes_->chain.build();
}

Estimate EyeCombiner::run(const EyeFrame& own, const EyeFrame& other, const Correspondence& where,
                          Image& weight, FrameReport& report) {
  Estimate result(task_.full, task_.carried());
  EyePasses& passes = *passes_;
  gpu::Chain& chain = passes.chain;
  for (const Tile& tile : tiles_) {
    chain.upload<float>(passes.exposure)[0] = own.frame.exposure;
    const auto origin = chain.upload<float>(passes.window.target_origin);
    origin[0] = static_cast<float>(tile.target.x - tile.source.x);
    origin[1] = static_cast<float>(tile.target.y - tile.source.y);
    passes.own.upload(chain, own, tile.target);
    passes.other.upload(chain, other, tile.source);
    upload(chain, passes.offset, view(where.offset), tile.target);
    if (passes.expected_depth) upload(chain, *passes.expected_depth, view(where.depth), tile.target);
    chain.run();
    add_times(report, chain);
    copy_core(chain.download<float>(passes.color), tile, result.color);
    copy_core(chain.download<float>(passes.stats), tile, result.stats);
    copy_core(download_additive(chain, passes.carried), tile, result.additive);
    copy_core(chain.download<float>(passes.weight), tile, weight);
  }
  return result;
}

FilterMemory EyeCombiner::memory() const {
  FilterMemory memory{
      .tiles = tiles_.size(), .tile = tiles_.front().target.extent(), .tile_plan = describe(tiles_)};
  add_memory(memory, passes_->chain);
  return memory;
}

}  // namespace becalm::filter
