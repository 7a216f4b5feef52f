#pragma once

// A search that is cut into tiles: features by tile, the coarse levels for the whole frame, then the finer
// levels by tile (add_search_passes), from the offsets of the coarse ones.

#include <cstddef>
#include <optional>
#include <string>

#include "filter/align/align.h"
#include "filter/gpu/chain.h"
#include "filter/task.h"
#include "filter/tiles/tiles.h"
#include "frame/image.h"

namespace becalm::filter {

/// The pyramid level that separates the search of the whole frame from that of the tiles.
struct PyramidSplit {
  std::size_t levels = 1;  ///< of the whole frame's pyramid
  /// The levels from this one on are searched for the whole frame at once; none if it equals `levels`.
  std::size_t coarse = 1;

  bool has_coarse() const { return coarse < levels; }
};

/// Matching features of a part of a frame, made from its colour and its guides. The history's guides are the
/// previous frame's guide features, at matching resolution.
struct FeatureChain {
  enum class Of { new_frame, history };
  enum class Outputs { finest_and_coarse, coarse };
  FeatureChain(gpu::Device& device, const FilterTask& task, const PyramidSplit& split, Of of,
               gpu::Extent part, Outputs outputs = Outputs::finest_and_coarse);

  gpu::Chain chain;
  gpu::ImageId color;
  gpu::ImageId exposure;
  /// At full resolution for a new frame, at matching resolution for the history.
  std::optional<gpu::ImageId> guide;
  Features finest;
  std::optional<Features> coarse;  ///< at level `coarse` of the split
};

/// Searches the offsets at level `coarse` for the whole frame.
struct CoarseChain {
  CoarseChain(gpu::Device& device, const FilterTask& task, const PyramidSplit& split);

  gpu::Chain chain;
  Features target;
  Features source;
  std::optional<gpu::ImageId> motion;  ///< at full resolution, if it is a candidate at a coarse level
  gpu::ImageId offset;
};

/// What the features of a new frame are made from, at full resolution.
struct FrameInputs {
  gpu::ImageId color;
  std::optional<gpu::ImageId> guide;  ///< if the task has guides
};

/// An input for a frame's guides at full resolution; none if the task has no guides.
std::optional<gpu::ImageId> guide_input(gpu::Chain& chain, const FilterTask& task, const std::string& name,
                                        gpu::Extent part);

/// Makes the features of a new frame. `guide_features`, at matching resolution, receives those of its guides;
/// without it they get an image of their own.
Features add_frame_features(gpu::Chain& chain, const FilterTask& task, gpu::Extent part,
                            const std::string& name, const FrameInputs& inputs, gpu::ImageId exposure,
                            std::optional<gpu::ImageId> guide_features = std::nullopt);

/// Matching features as an input, at level 0 or at a coarser one.
Features feature_input(gpu::Chain& chain, const std::string& name, gpu::Extent extent, int planes);

/// Whether known motion is a candidate in the coarse chain, rather than at a finer level.
bool coarse_takes_motion(const FilterTask& task, const PyramidSplit& split);

/// Largest component of the offsets at which the tiles' search starts, in full-resolution pixels.
int start_limit_px(const FilterTask& task, const PyramidSplit& split);

/// The offsets that the coarse chain's last run found.
Image download_offset(const CoarseChain& coarse, const FilterTask& task, const PyramidSplit& split);

/// Uploads the coarse chain's offsets of the whole frame, from which the search in a tile starts.
void upload_start(gpu::Chain& chain, gpu::ImageId start, const Image& coarse_offset, const FilterTask& task,
                  const PyramidSplit& split, const Rect& target);

/// A rectangle in pixels of a level. `px` is the side of such a pixel; `rect` begins at multiples of it.
Rect at_level(const Rect& rect, int px);

}  // namespace becalm::filter
