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

/// The image, and its channel, that hold the variance of a frame before smoothing.
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
  /// For a smoothed frame: tells which part of its expected squared error is blur. The history has the same
  /// blur, so that part explains no difference between the two. Without it, the whole error counts as blur.
  std::optional<NoisyVariance> noisy = {};
};

/// Statistics of a frame against the warped history.
MergeStatistics add_statistics(gpu::Chain& chain, gpu::Extent full, const FrameToCompare& frame,
                               const WarpedHistory& warped);

}  // namespace becalm::filter
