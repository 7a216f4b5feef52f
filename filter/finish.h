#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "filter/frame_merger.h"
#include "filter/gpu/chain.h"
#include "filter/tiles.h"

namespace becalm::filter {

/// What the finishing passes make a frame from.
struct FinishInputs {
  const NewFrame& frame;
  const Estimate& forward;     ///< includes the frame
  const Estimate& prediction;  ///< from the frames after it, without the frame
};

/// The passes of one tile that turn the estimates of both directions into the output.
struct FinishChain {
  FinishChain(gpu::Device& device, const FilterTask& task, gpu::Extent extent);

  gpu::Chain chain;
  gpu::ImageId exposure;
  gpu::ImageId forward_color;
  gpu::ImageId forward_stats;
  gpu::ImageId prediction_color;
  gpu::ImageId prediction_stats;
  std::vector<gpu::ImageId> forward_additive;
  std::vector<gpu::ImageId> prediction_additive;
  gpu::ImageId color;
  gpu::ImageId stats;
  std::vector<gpu::ImageId> additive;
};

/// What happens to a frame once all that other frames know of it is there. It keeps nothing from frame to
/// frame and depends on a pixel's surroundings alone, so frames that the device cannot hold are cut into
/// tiles, which the results do not show.
class Finish {
 public:
  /// Plans the largest tiles that take at most `memory_limit` bytes. Throws DeviceLimitError if not even the
  /// smallest do.
  Finish(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit);

  /// Adds the device times to the report. The result's images have the frame's size.
  void run(const FinishInputs& inputs, Estimate& result, FrameReport& report);
  FilterMemory memory() const;

 private:
  void run_tile(const Tile& tile, const FinishInputs& inputs, Estimate& result);

  std::vector<Tile> tiles_;
  std::unique_ptr<FinishChain> chain_;
};

}  // namespace becalm::filter
