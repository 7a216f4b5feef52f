#pragma once

#include <optional>

#include "filter/align/search_chains.h"
#include "filter/gpu/chain.h"
#include "filter/task.h"

namespace becalm::filter {

/// The chain that aligns a tile of one frame with another frame: features of both, and the search at the
/// levels finer than the split's coarse ones, which for a frame that is not cut are all.
struct PairSearch {
  /// `target` is the size of the target's images, `source` of the source's.
  PairSearch(gpu::Device& device, const FilterTask& task, const PyramidSplit& split, gpu::Extent target,
             gpu::Extent source);

  gpu::Chain chain;
  gpu::ImageId exposure;       ///< of the target
  gpu::ImageId target_origin;  ///< position of the target rectangle in the source rectangle
  FrameInputs target;
  FrameInputs source;
  std::optional<gpu::ImageId> start;  ///< offsets at level `coarse` of the split
  gpu::ImageId offset;                ///< outputs
  gpu::ImageId residual;
};

}  // namespace becalm::filter
