#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "filter/gpu/device.h"
#include "filter/gpu/profiler.h"
#include "filter/settings.h"
#include "frame/frame.h"

namespace becalm::filter {

struct PairAlignment {
  /// Two channels, the frames' size, in pixels: source(p + offset) looks like target(p).
  Image offset;
  /// One channel: the patch distance at the offset for each pyramid level, the finest first, at the sizes of
  /// pyramid_extents.
  std::vector<Image> residual;
  std::vector<gpu::PassTime> passes;  ///< device time, in order of execution
};

/// Aligns one frame with another by the search that SequenceFilter uses for its history, without merging. The
/// frames are matched by radiance, scaled by the target's exposure, and, if `settings.guides` is 1, by albedo
/// and normal where available.
class PairAligner {
 public:
  /// Throws DeviceError if the device fails or cannot hold the images.
  PairAligner(gpu::Device& device, const Settings& settings, int width, int height, const AovSet& available);
  ~PairAligner();
  PairAligner(PairAligner&&) noexcept;

  /// Throws Error(bad_input) if a frame has another size or lacks an AOV that is matched, or if the target
  /// lacks the motion that is used.
  PairAlignment align(const Frame& target, const Frame& source);

  /// Device memory held, and what it would be if images did not share memory.
  std::uint64_t device_bytes() const;
  std::uint64_t device_bytes_unaliased() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::filter
