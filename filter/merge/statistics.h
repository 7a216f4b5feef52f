#pragma once

#include <optional>

#include "filter/gpu/chain.h"
#include "filter/merge/merge.h"

namespace becalm::filter {

/// What each pixel adds to the sums of a patch that tell whether a frame and its history differ by more than
/// noise. Both f32x4, 0 in pixels that do not count; shaders/merge/statistics.comp lists their channels.
struct MergeStatistics {
  gpu::ImageId difference;
  gpu::ImageId noise;
};

/// A frame whose statistics are taken.
struct FrameToCompare {
  gpu::ImageId color;     ///< f32x4, as MergeInputs::color
  gpu::ImageId variance;  ///< f32x2, as MergeInputs::variance
  gpu::ImageId exposure;  ///< f32, 1x1
  /// Of a smoothed frame: the noisy frame's variance (f32x2), which tells how much of the smoothed one's
  /// squared error is blur. Without it, errors count as noise.
  std::optional<gpu::ImageId> noisy_variance = {};
};

/// Statistics of a frame against the warped history.
MergeStatistics add_statistics(gpu::Chain& chain, gpu::Extent full, const FrameToCompare& frame,
                               const WarpedHistory& warped);

}  // namespace becalm::filter
