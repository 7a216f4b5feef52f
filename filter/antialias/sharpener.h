#pragma once

#include <cstdint>

#include "filter/gpu/chain.h"
#include "filter/report.h"
#include "filter/task.h"
#include "filter/tiles/local_chain.h"
#include "frame/image.h"

namespace becalm::filter {

/// The pass that sharpens a frame, which has a colour image (f32x4).
struct SharpenPasses {
  SharpenPasses(gpu::Device& device, const FilterTask& task, gpu::Extent extent);

  gpu::Chain chain;
  gpu::ImageId color;
  gpu::ImageId amount;  ///< f32, 1x1: in [0,1]
  gpu::ImageId sharpened;
};

/// Sharpens frames within the range of each pixel's neighbours.
class Sharpener {
 public:
  /// Throws DeviceLimitError if even the smallest tiles take more than `memory_limit` bytes.
  Sharpener(gpu::Device& device, const FilterTask& task, float amount, std::uint64_t memory_limit)
      : amount_(amount), chain_(device, task, memory_limit) {}

  /// Four channels in, four out. Adds the device times to the report.
  Image run(const Image& color, FrameReport& report);
  FilterMemory memory() const { return chain_.memory(); }

 private:
  float amount_;
  LocalChain<SharpenPasses> chain_;
};

}  // namespace becalm::filter
