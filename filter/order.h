#pragma once

#include <cstdint>
#include <limits>
#include <memory>

#include "filter/frame_merger.h"
#include "filter/gpu/device.h"
#include "filter/settings.h"
#include "frame/frame.h"

namespace becalm::filter {

/// AOVs that the filter uses when a frame has them; what else a frame carries is ignored.
AovSet wanted_aovs(const Settings& settings);

/// Denoises a sequence forward in time: every frame is aligned with the history of the frames before it and
/// merged. One frame out for each frame in, in the same order. All frames have the size given at construction
/// and the AOVs of `available` that the filter wants; a frame that differs throws Error(bad_input).
class ForwardFilter {
 public:
  /// Builds the chains for this size. `diagnostics` are those of the AOV table's to put into the
  /// results. Frames that the device cannot hold whole, or not within `memory_limit` bytes, are cut
  /// into tiles, which the results do not show. Throws gpu::DeviceError if the smallest tiles are still too
  /// large.
  ForwardFilter(gpu::Device& device, const Settings& settings, int width, int height, AovSet available,
                AovSet diagnostics = {},
                std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max());
  ~ForwardFilter();
  ForwardFilter(ForwardFilter&&) noexcept;

  Denoised denoise(const Frame& frame);

  /// Forgets the history: the next frame starts anew, as after a cut or a missing frame.
  void reset();

  /// How the frames are cut, and the device memory held for it.
  FilterMemory memory() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::filter
