#pragma once

#include "filter/gpu/chain.h"
#include "filter/merge/merge.h"

namespace becalm::filter {

/// What each pixel adds to the sums of a patch that tell whether a frame and its history differ by more than
/// noise. Both f32x4, 0 in pixels that do not count; shaders/merge/statistics.comp lists their channels.
struct MergeStatistics {
  gpu::ImageId difference;
  gpu::ImageId noise;
};

/// Statistics of a frame against the warped history. `color` (f32x4) and `variance` (f32x2) are as those of
/// MergeInputs, `exposure` is the frame's.
MergeStatistics add_statistics(gpu::Chain& chain, gpu::Extent full, gpu::ImageId color, gpu::ImageId variance,
                               const WarpedHistory& warped, gpu::ImageId exposure);

}  // namespace becalm::filter
