#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include "filter/gpu/device.h"
#include "filter/report.h"
#include "filter/settings.h"
#include "frame/frame.h"

namespace becalm::filter {

struct PairAlignment {
  /// Two channels, the frames' size, in pixels: source(p + offset) looks like target(p).
  Image offset;
  /// One channel: the patch distance at the offset at the finest pyramid level, at that level's size.
  Image residual;
};

/// Aligns one frame with another by the search that SequenceFilter uses for its history, without merging. The
/// frames are matched by radiance, scaled by the target's exposure, and, if `settings.guides`, by albedo
/// and normal where available; known motion is not used. A frame that the device cannot hold is cut, as
/// FrameMerger does it: the results do not depend on the cut.
class PairAligner {
 public:
  /// Chooses the largest tiles whose chains hold at most `memory_limit` bytes on the device. Throws
  /// DeviceLimitError if even the smallest tiles hold more, and DeviceError if the device fails.
  PairAligner(gpu::Device& device, const Settings& settings, int width, int height, const AovSet& available,
              std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max());
  ~PairAligner();
  PairAligner(PairAligner&&) noexcept;

  /// Adds the device times to the report. Throws Error(bad_input) if a frame has another size or lacks an AOV
  /// that is matched.
  PairAlignment align(const Frame& target, const Frame& source, FrameReport& report);
  FilterMemory memory() const;

 private:
  struct Chains;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::filter
