#pragma once

#include <cstdint>

#include "filter/estimate.h"
#include "filter/report.h"
#include "filter/smooth/frame_smoother.h"
#include "filter/task.h"

namespace becalm::filter {

/// The noisy layers that an estimate carries, as images of an AOV's channels.
struct Accumulated {
  Image color;     ///< RGB
  Image variance;  ///< Y: of a frame over the effective number of frames
  Image albedo;    ///< RGB
  Image normal;    ///< XYZ
  Image depth;     ///< Y: of pack_features, in [0,2]
};

/// Smooths noisy frames that were merged, with the features of the frame where they were merged. What is left
/// of the noise after that is less than after merging smoothed frames: detail that many frames share is no
/// longer taken for noise.
class MergedSmoother {
 public:
  /// As FrameSmoother.
  MergedSmoother(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit);

  /// `merged` carries the noisy radiance and its variance summed with the merge's weights; returns what is to
  /// come out for the frame.
  Estimate smooth(const NewFrame& frame, Estimate merged, FrameReport& report);
  FilterMemory memory() const { return smoother_.memory(); }

 private:
  FilterTask task_;
  FrameSmoother smoother_;
};

Accumulated accumulated(const Estimate& merged);

}  // namespace becalm::filter
