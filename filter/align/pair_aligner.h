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

/// Aligns one frame with another, as SequenceFilter aligns its history with each frame, but with nothing
/// merged. The frames are matched by radiance, scaled by the target's exposure, and by those of albedo and
/// normal that are available and weighed.
class PairAligner {
 public:
  /// Throws Error(usage) if the settings leave nothing to match, DeviceError for trouble with the device.
  PairAligner(gpu::Device& device, const Settings& settings, int width, int height, const AovSet& available);
  ~PairAligner();
  PairAligner(PairAligner&&) noexcept;

  /// Throws Error(bad_input) if a frame has another size or lacks an AOV that is matched.
  PairAlignment align(const Frame& target, const Frame& source);

  /// Device memory held, and what it would be without sharing.
  std::uint64_t device_bytes() const;
  std::uint64_t device_bytes_unaliased() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::filter
