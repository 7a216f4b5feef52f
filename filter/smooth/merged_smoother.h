#pragma once

#include <cstdint>

#include "filter/estimate.h"
#include "filter/report.h"
#include "filter/smooth/frame_smoother.h"
#include "filter/task.h"

namespace becalm::filter {

/// The noisy layers that an estimate carries, as images with an AOV's channels.
struct Accumulated {
  Image color;     ///< RGB
  Image variance;  ///< Y: variance of one frame / effective number of frames
  Image albedo;    ///< RGB
  Image normal;    ///< XYZ
  Image depth;     ///< Y: as from pack_features, in [0,2]
};

/// Smooths merged noisy frames, with the merged features and those of the unmerged frame. The remaining error
/// is smaller than after merging smoothed frames: detail that many frames share is no longer taken for noise.
class MergedSmoother {
 public:
  /// As FrameSmoother's constructor.
  MergedSmoother(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit);

  /// `merged` carries the noisy layers, merged with the merge's weights. Returns the estimate to output for
  /// `frame`.
  Estimate smooth(const NewFrame& frame, Estimate merged, FrameReport& report);
  FilterMemory memory() const { return smoother_.memory(); }

 private:
  FilterTask task_;
  FrameSmoother smoother_;
};

Accumulated accumulated(const Estimate& merged);

}  // namespace becalm::filter
