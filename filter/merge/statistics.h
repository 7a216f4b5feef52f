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

/// Where the variance of a frame is that is not smoothed.
struct NoisyVariance {
  gpu::ImageId image;
  int channel = 0;
};

/// A frame whose statistics are taken.
struct FrameToCompare {
  gpu::ImageId color;     ///< f32x4, as MergeInputs::color
  gpu::ImageId variance;  ///< f32x2, as MergeInputs::variance
  gpu::ImageId exposure;  ///< f32, 1x1
  bool smoothed = false;  ///< its variance is the error that the smoother expects
  /// Of a smoothed frame: tells how much of its squared error is blur, which its history has alike. Where it
  /// is not known, all is taken for blur, which explains no difference.
  std::optional<NoisyVariance> noisy = {};
};

/// Statistics of a frame against the warped history.
MergeStatistics add_statistics(gpu::Chain& chain, gpu::Extent full, const FrameToCompare& frame,
                               const WarpedHistory& warped);

}  // namespace becalm::filter
