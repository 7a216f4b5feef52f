#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "filter/align/pyramid.h"
#include "filter/align/search_chains.h"
#include "filter/gpu/device.h"
#include "filter/task.h"
#include "filter/tiles/tiles.h"

namespace becalm::filter {

/// What tiles need, whatever their size.
struct CutRules {
  TileRules tiles;
  TileRules features;  ///< of the tiles in which features are made
};

/// A frame whose coarse levels are searched at once and whose finer levels by tile. `Chains` has the chains
/// for tiles of one size, planned: it is constructed from (device, task, split, tile), and has the members
/// `device_bytes()` and `static CutRules cut_rules(device, task, split)`.
template <class Chains>
struct SplitPlan {
  std::unique_ptr<Chains> chains;
  std::vector<Tile> tiles;
  std::vector<Tile> feature_tiles;  ///< in which features are made, of the same size
};

/// The chains for the whole frame as one tile, or null if they take more than `memory_limit` bytes or an
/// image is too large for the device. `make(split)` returns them as std::unique_ptr.
template <class Make>
auto plan_whole_frame(const FilterTask& task, std::uint64_t memory_limit, const Make& make) {
  const std::size_t levels = pyramid_extents(task.settings, task.full.width, task.full.height).size();
  decltype(make(PyramidSplit{})) chains;
  try {
    chains = make(PyramidSplit{.levels = levels, .coarse = levels});
  } catch (const gpu::DeviceLimitError&) {
    return chains;
  }
  if (chains->device_bytes() > memory_limit) chains.reset();
  return chains;
}

/// The split and the tiles of the least work that take at most `memory_limit` bytes. Throws DeviceLimitError
/// if even the smallest tiles take more.
template <class Chains>
SplitPlan<Chains> plan_split(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit) {
  const gpu::Extent full = task.full;
  const std::size_t levels = pyramid_extents(task.settings, full.width, full.height).size();
  std::uint64_t least_work = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t least_bytes = std::numeric_limits<std::uint64_t>::max();
  std::string reason;
  SplitPlan<Chains> best;
  for (std::size_t coarse = 1; coarse <= levels; ++coarse) {
    const PyramidSplit split{.levels = levels, .coarse = coarse};
    const CutRules rules = Chains::cut_rules(device, task, split);
    SplitPlan<Chains> plan;
    const auto fits = [&](const Tile& tile) {
      try {
        plan.chains = std::make_unique<Chains>(device, task, split, tile);
      } catch (const gpu::DeviceLimitError& error) {
        if (reason.empty()) reason = error.what();
        return false;
      }
      plan.feature_tiles = cut_tiles(full, tile.target.extent(), rules.features);
      if (plan.feature_tiles.empty()) {
        if (reason.empty()) reason = "features reach further than tiles have room for";
        return false;
      }
      const std::uint64_t bytes = plan.chains->device_bytes();
      if (bytes < least_bytes) {
        least_bytes = bytes;
        reason = tiles_too_large(tile, bytes, memory_limit);
      }
      return bytes <= memory_limit;
    };
    plan.tiles = plan_tiles(full, rules.tiles, fits);
    if (plan.tiles.empty()) continue;
    const std::uint64_t work = plan.tiles.size() * plan.tiles.front().target.extent().elements();
    if (work >= least_work) continue;
    least_work = work;
    best = std::move(plan);
  }
  if (best.tiles.empty()) throw cannot_be_cut(full, reason);
  return best;
}

}  // namespace becalm::filter
