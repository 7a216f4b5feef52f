#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/report.h"
#include "filter/task.h"
#include "filter/tiles/tiles.h"

namespace becalm::filter {

/// A chain without history whose pixels depend only on a margin around them, or on what passes gather from a
/// source rectangle around that. Frames that the device cannot hold are cut into tiles; the results do not
/// depend on the cut. `Passes` declares the chain for tiles of one size in its member `chain`, not yet
/// planned.
template <class Passes>
class LocalChain {
 public:
  /// Builds the chain for the largest tiles that take at most `memory_limit` bytes. `make(target, source)` is
  /// the passes for rectangles of these sizes, as std::unique_ptr. Throws DeviceLimitError if even the
  /// smallest tiles take more.
  template <class Make>
  LocalChain(gpu::Extent full, std::uint64_t memory_limit, const Make& make) {
    std::string reason;
    const TileRules rules = rules_for_both(make(full, full)->chain.tile_rules(), kCoarseGrid);
    tiles_ = plan_tiles(full, rules, [&](const Tile& tile) {
      passes_ = make(tile.target.extent(), tile.source.extent());
      try {
        passes_->chain.plan();
      } catch (const gpu::DeviceLimitError& error) {
        reason = error.what();
        return false;
      }
      const std::uint64_t bytes = passes_->chain.device_bytes().total();
      reason = tiles_too_large(tile, bytes, memory_limit);
      return bytes <= memory_limit;
    });
    if (tiles_.empty()) throw cannot_be_cut(full, reason);
    passes_->chain.build();
  }

  /// The same for passes that gather nothing, which are constructed from (device, task, extent).
  LocalChain(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit)
      : LocalChain(task.full, memory_limit, [&](gpu::Extent target, gpu::Extent) {
          return std::make_unique<Passes>(device, task, target);
        }) {}

  /// For each tile, `upload(passes, tile)` fills the inputs and `download(passes, tile)` reads the outputs.
  /// Adds the device times to the report.
  template <class Upload, class Download>
  void run(FrameReport& report, const Upload& upload, const Download& download) {
    for (const Tile& tile : tiles_) {
      upload(*passes_, tile);
      passes_->chain.run();
      add_times(report, passes_->chain);
      download(*passes_, tile);
    }
  }

  /// Whether frames are not cut.
  bool is_whole() const { return tiles_.size() == 1; }

  /// For uploading tables that are the same in every run.
  Passes& passes() { return *passes_; }

  FilterMemory memory() const {
    FilterMemory memory{
        .tiles = tiles_.size(), .tile = tiles_.front().target.extent(), .tile_plan = describe(tiles_)};
    add_memory(memory, passes_->chain);
    return memory;
  }

 private:
  /// Keeps the sizes that are tried few.
  static constexpr TileRules kCoarseGrid{.grid = 8, .core_grid = 8};

  std::vector<Tile> tiles_;
  std::unique_ptr<Passes> passes_;
};

}  // namespace becalm::filter
