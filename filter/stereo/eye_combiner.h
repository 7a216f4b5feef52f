#pragma once

#include <cstdint>

#include "filter/estimate.h"
#include "filter/gpu/device.h"
#include "filter/report.h"
#include "filter/stereo/disparity.h"
#include "filter/stereo/eye_passes.h"
#include "filter/task.h"
#include "filter/tiles/local_chain.h"

namespace becalm::filter {

/// Combines an eye's estimate of a frame with the other eye's, tile by tile.
class EyeCombiner {
 public:
  /// Plans the largest tiles that take at most `memory_limit` bytes; `limit_px` is that of EyePasses.
  /// Throws DeviceLimitError if even the smallest tiles take more.
  EyeCombiner(gpu::Device& device, const FilterTask& task, int limit_px, std::uint64_t memory_limit);

  /// `weight`, if not empty, becomes the other eye's weight in each pixel. Adds the device times to the
  /// report.
  Estimate run(const EyeFrame& own, const EyeFrame& other, const Correspondence& where, Image& weight,
               FrameReport& report);
  FilterMemory memory() const { return chain_.memory(); }

 private:
  FilterTask task_;
  LocalChain<EyePasses> chain_;
};

}  // namespace becalm::filter
