#pragma once

// The chains that merge a frame with its history; frame_merger.cpp says in which order they run.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "filter/align/align.h"
#include "filter/gpu/chain.h"
#include "filter/input/noisy_inputs.h"
#include "filter/merge/merge.h"
#include "filter/task.h"

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

/// What a merge left of one tile's target rectangle; spans of what nobody wants are empty.
struct MergedTile {
  std::span<const float> color;
  std::span<const float> stats;
  std::span<const float> warped_color;
  std::span<const float> warped_stats;
  std::vector<std::span<const float>> additive;         ///< as `color`
  std::vector<std::span<const float>> warped_additive;  ///< as `warped_color`
  std::span<const float> decision;
  std::span<const float> offset;    ///< at full resolution
  std::span<const float> residual;  ///< of the finest level
};

/// The finer levels of the search, and the merge, for one tile. A tile that is the whole frame makes its own
/// features and keeps its history on the device; of other tiles both are inputs.
struct MergeChain {
  MergeChain(gpu::Device& device, const FilterTask& task, const PyramidSplit& split, gpu::Extent target,
             gpu::Extent source, bool is_whole_frame);

  MergedTile download() const;

  gpu::Chain chain;
  NoisyInputs noisy;
  gpu::ImageId smoothed_color;  ///< if the task smooths
  gpu::ImageId smoothed_stats;
  std::optional<gpu::ImageId> motion;  ///< if a level of the tile starts from it, or offsets are to be that
  std::optional<FramePair> albedo;
  std::vector<gpu::ImageId> additive;  ///< of the new frame, or smoothed
  gpu::History color;                  ///< `previous` is an input unless the tile is the whole frame
  gpu::History stats;
  std::vector<gpu::History> carried;
  std::optional<gpu::ImageId> guide;  ///< of the whole frame: its guides at full resolution

  /// Inputs of tiles that are not the whole frame.
  struct Cut {
    gpu::ImageId target_origin;  ///< where the target's rectangle begins in the source's
    Features target;             ///< of level 0, as is the source
    Features source;
    std::optional<gpu::ImageId> start;  ///< offsets of level `coarse`
  };
  std::optional<Cut> cut;

 private:
  /// How the tile's target and source are matched.
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
