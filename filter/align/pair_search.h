#pragma once

#include <optional>
#include <string>

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

  /// Inputs of one of the two frames, at full resolution.
  struct Inputs {
    gpu::ImageId color;
    std::optional<gpu::ImageId> guide;
  };

  gpu::Chain chain;
  gpu::ImageId exposure;       ///< of the target
  gpu::ImageId target_origin;  ///< position of the target rectangle in the source rectangle
  Inputs target;
  Inputs source;
  std::optional<gpu::ImageId> start;   ///< offsets at level `coarse` of the split
  std::optional<gpu::ImageId> motion;  ///< candidate or offset, if the tile uses it
  gpu::ImageId offset;                 ///< outputs
  gpu::ImageId residual;

 private:
  Features add_features(const FilterTask& task, gpu::Extent extent, const std::string& name, Inputs& inputs);
};

}  // namespace becalm::filter
