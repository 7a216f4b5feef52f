#pragma once

#include <cstdint>

#include "filter/estimate.h"
#include "filter/report.h"
#include "filter/task.h"
#include "filter/tiles/local_chain.h"

namespace becalm::filter {

/// Smooths single frames before they are matched and merged, so that decisions are made on what is hardly
/// noisy.
class FrameSmoother {
 public:
  /// Plans the largest tiles that take at most `memory_limit` bytes. Throws DeviceLimitError if not even the
  /// smallest do.
  FrameSmoother(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit);
  ~FrameSmoother();

  /// The frame smoothed: its colour, and (variance left, 1; or 0 for a pixel that is not finite).
  Estimate smooth(const NewFrame& frame, FrameReport& report);
  FilterMemory memory() const;

 private:
  struct Passes;
  FilterTask task_;
  LocalChain<Passes> chain_;
};

}  // namespace becalm::filter
