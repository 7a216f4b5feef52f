#pragma once

// The chains that make a frame in tiles; tiled_frame.cpp says in which order they run.

#include <cstddef>
#include <optional>
#include <vector>

#include "filter/align.h"
#include "filter/frame_merger.h"
#include "filter/gpu/chain.h"
#include "filter/merge.h"
#include "filter/merged_images.h"
#include "filter/noisy_inputs.h"

namespace becalm::filter {

/// Where the search of the whole frame ends and that of the tiles begins.
struct PyramidSplit {
  std::size_t levels = 1;  ///< of the whole frame's pyramid
  std::size_t coarse =
      1;  ///< levels from this one on are searched for the whole frame at once, if there are any

  bool has_coarse() const { return coarse < levels; }
};

/// Matching features of a part of a frame, from its colour and its guides. The guides of a history are those
/// of the frame before, which are features already.
struct FeatureChain {
  enum class Of { new_frame, history };
  FeatureChain(gpu::Device& device, const FilterTask& task, const PyramidSplit& split, Of of,
               gpu::Extent part);

  gpu::Chain chain;
  gpu::ImageId color;
  gpu::ImageId exposure;
  std::optional<gpu::ImageId>
      guide;  ///< at full resolution for a new frame, at matching resolution for a history
  Features finest;
  std::optional<Features> coarse;  ///< of level `coarse` of the split
};

/// The offsets of level `coarse`, for the whole frame.
struct CoarseChain {
  CoarseChain(gpu::Device& device, const FilterTask& task, const PyramidSplit& split, int planes);

  gpu::Chain chain;
  Features target;
  Features source;
  std::optional<gpu::ImageId> motion;  ///< at full resolution, if a coarse level starts from it
  gpu::ImageId offset;
};

/// The finer levels and the merge, for one tile.
struct TileChain {
  TileChain(gpu::Device& device, const FilterTask& task, const PyramidSplit& split, int planes,
            gpu::Extent target_extent, gpu::Extent source_extent);

  gpu::Chain chain;
  NoisyInputs noisy;
  gpu::ImageId smoothed_color;  ///< if the task smooths
  gpu::ImageId smoothed_stats;
  Features target;  ///< of level 0, as are the source's
  Features source;
  std::optional<gpu::ImageId> start;   ///< offsets of level `coarse`
  std::optional<gpu::ImageId> motion;  ///< if a level of the tile starts from it, or offsets are to be that
  gpu::ImageId target_origin;          ///< where the target's rectangle begins in the source's
  std::optional<FramePair> albedo;
  gpu::ImageId history_color;
  gpu::ImageId history_stats;
  std::vector<gpu::ImageId> additive;  ///< of the new frame, or smoothed
  std::vector<gpu::ImageId> history_additive;
  MergedImages merged;
};

}  // namespace becalm::filter
