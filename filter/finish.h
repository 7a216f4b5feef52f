#pragma once

#include <cstdint>

#include "filter/frame_merger.h"
#include "filter/local_chain.h"

namespace becalm::filter {

/// What the finishing passes make a frame from.
struct FinishInputs {
  const NewFrame& frame;
  const Estimate& forward;     ///< includes the frame
  const Estimate& prediction;  ///< from the frames after it, without the frame
};

/// What happens to a frame once all that other frames know of it is there.
class Finish {
 public:
  /// Plans the largest tiles that take at most `memory_limit` bytes. Throws DeviceLimitError if not even the
  /// smallest do.
  Finish(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit);
  ~Finish();

  /// Adds the device times to the report. The result's images have the frame's size.
  void run(const FinishInputs& inputs, Estimate& result, FrameReport& report);
  FilterMemory memory() const;

 private:
  struct Passes;
  LocalChain<Passes> chain_;
};

}  // namespace becalm::filter
