#pragma once

#include <vector>

#include "filter/frame_merger.h"
#include "filter/gpu/chain.h"
#include "filter/merge.h"

namespace becalm::filter {

/// What is merged with the beauty's weights: the additive AOVs given, then the noisy layers if the task
/// smooths what is merged. `history` has one for each.
std::vector<CarriedInput> carried_inputs(gpu::Chain& chain, const FilterTask& task, gpu::Extent extent,
                                         const NoisyInputs& noisy, const std::vector<gpu::ImageId>& additive,
                                         const std::vector<gpu::History>& history);

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
