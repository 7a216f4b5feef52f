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

  /// Replaces the estimate's colour, expected error and additive AOVs, if the frame differs from it by less
  /// than 2.5 % of the squared brightness; up to 1.5 % with the whole share, above with a part.
  void mix(const NewFrame& frame, Estimate& estimate, FrameReport& report);
  FilterMemory memory() const;

 private:
  struct Passes;
  FilterTask task_;
  LocalChain<Passes> chain_;
};

}  // namespace becalm::filter
