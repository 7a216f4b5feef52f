#pragma once

// The chains that merge a frame with its history; frame_merger.cpp runs them in order.

#include <optional>
#include <span>
#include <vector>

#include "filter/align/align.h"
#include "filter/align/search_chains.h"
#include "filter/gpu/chain.h"
#include "filter/input/noisy_inputs.h"
#include "filter/merge/merge.h"
#include "filter/task.h"

namespace becalm::filter {

/// Results of a merge in a tile's target rectangle; spans that are not wanted are empty.
struct MergedTile {
  std::span<const float> color;
  std::span<const float> stats;
  std::span<const float> warped_color;
  std::span<const float> warped_stats;
  std::vector<std::span<const float>> carried;         ///< as `color`
  std::vector<std::span<const float>> warped_carried;  ///< as `warped_color`
  std::span<const float> decision;
  std::span<const float> offset;    ///< at full resolution
  std::span<const float> residual;  ///< at the finest level
};

/// The search at the finer levels and the merge, for one tile. For a tile that is the whole frame, the chain
/// makes the features and keeps the history on the device; for other tiles both are inputs.
struct MergeChain {
  MergeChain(gpu::Device& device, const FilterTask& task, const PyramidSplit& split, gpu::Extent target,
             gpu::Extent source, bool is_whole_frame);

  MergedTile download() const;

  gpu::Chain chain;
  NoisyInputs noisy;
  gpu::ImageId smoothed_color;  ///< if the task smooths
  gpu::ImageId smoothed_stats;
  std::optional<gpu::ImageId> motion;  ///< candidate or offset, if the tile uses it
  std::vector<gpu::ImageId> additive;  ///< of the new frame, noisy or smoothed
  gpu::History color;                  ///< `previous` is an input unless the tile is the whole frame
  gpu::History stats;
  std::vector<gpu::History> carried;
  std::optional<gpu::ImageId> guide;  ///< if the tile is the whole frame: guides at full resolution

  /// Inputs of tiles that are not the whole frame.
  struct Cut {
    gpu::ImageId target_origin;  ///< position of the target rectangle in the source rectangle
    Features target;             ///< at level 0, as is the source
    Features source;
    std::optional<gpu::ImageId> start;  ///< offsets at level `coarse`
  };
  std::optional<Cut> cut;

 private:
  /// Features of the tile's target and source.
  struct Matched {
    Features target;
    Features source;
    SourceWindow window;
  };
  gpu::History history(const std::string& name, gpu::Format format, bool is_whole_frame, gpu::Extent target,
                       gpu::Extent source);
  Matched features_of_frame(const FilterTask& task, gpu::ImageId target_color);
  Matched features_of_tile(const FilterTask& task, const PyramidSplit& split, gpu::Extent target,
                           gpu::Extent source);
  void add_outputs(const FilterTask& task);

  MergeOutputs outputs_;
  gpu::ImageId offset_;
  gpu::ImageId residual_;
  bool predicts_ = false;
  bool wants_offset_ = false;
  bool wants_residual_ = false;
};

}  // namespace becalm::filter
