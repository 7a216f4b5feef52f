#pragma once

#include <vector>

#include "filter/frame_merger.h"
#include "filter/gpu/chain.h"
#include "filter/merge.h"

namespace becalm::filter {

/// Where a chain leaves what it makes of a tile's target rectangle.
struct MergedImages {
  gpu::ImageId color;  ///< the history of the next frame, as are `stats` and `additive`
  gpu::ImageId stats;
  std::vector<gpu::ImageId> additive;
  MergeOutputs outputs;
  gpu::ImageId offset;    ///< at full resolution
  gpu::ImageId residual;  ///< of the finest level
};

/// Makes outputs of the chain of those that the task wants.
void add_outputs(gpu::Chain& chain, const FilterTask& task, const MergedImages& images);

/// Those outputs after a run.
MergedTile download(const gpu::Chain& chain, const FilterTask& task, const MergedImages& images);

}  // namespace becalm::filter
