#pragma once

#include <cstdint>

#include "filter/estimate.h"
#include "filter/report.h"
#include "filter/task.h"
#include "filter/tiles/local_chain.h"

namespace becalm::filter {

/// Mixes nearly clean frames with estimates of them that were made of smoothed frames (own_share.h), since
/// smoothing takes more detail than noise there. For frames that came without variance: an estimated variance
/// counts detail as noise, so smooth/share does not put detail back. With a known variance it does, and a mix
/// would only add noise. Noisy frames would gain too little for the time.
class FrameMixer {
 public:
  /// As FrameSmoother's constructor.
  FrameMixer(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit);
  ~FrameMixer();

  /// Mixes the frame into the estimate's colour and additive AOVs, and updates the expected error, if the
  /// squared difference of both colours relative to the brightness (1 at most in a pixel) has a mean below
  /// 0.025. Up to 0.015 the frame has the share of own_share.h, which falls to 0 from there to 0.025.
  void mix(const NewFrame& frame, Estimate& estimate, FrameReport& report);
  FilterMemory memory() const;

 private:
  struct Passes;
  FilterTask task_;
  LocalChain<Passes> chain_;
};

}  // namespace becalm::filter
