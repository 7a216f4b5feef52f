#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "filter/estimate.h"
#include "filter/gpu/chain.h"
#include "filter/report.h"
#include "filter/task.h"
#include "filter/tiles/tiles.h"

namespace becalm::filter {

/// What is known of one eye's frame, all of one size.
struct EyeFrame {
  const NewFrame& frame;
  const Estimate& estimate;
};

/// Combines an eye's estimate of a frame with the other eye's, tile by tile.
class EyeCombiner {
 public:
  /// Plans the largest tiles that take at most `memory_limit` bytes. `has_depth`: frames have depth; offsets
  /// into the other eye's image have components of at most `limit_px`. Throws DeviceLimitError if even the
  /// smallest tiles take more.
  EyeCombiner(gpu::Device& device, const FilterTask& task, bool has_depth, int limit_px,
              std::uint64_t memory_limit);
  ~EyeCombiner();
  EyeCombiner(EyeCombiner&&) noexcept;

  /// `candidates` has four channels, as stereo/choose_offset reads them. `weight`, if not empty, becomes the
  /// other eye's weight in each pixel. Adds the device times to the report.
  Estimate run(const EyeFrame& own, const EyeFrame& other, const Image& candidates, Image& weight,
               FrameReport& report);
  FilterMemory memory() const;

 private:
  struct Passes;
  FilterTask task_;
  std::vector<Tile> tiles_;
  std::unique_ptr<Passes> passes_;
};

}  // namespace becalm::filter
