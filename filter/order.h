#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "filter/gpu/device.h"
#include "filter/gpu/profiler.h"
#include "filter/settings.h"
#include "frame/frame.h"

namespace becalm::filter {

/// What happened to one frame.
struct FrameReport {
  std::size_t non_finite_pixels = 0;   ///< input pixels with NaN or Inf in beauty or guide; passed through as they came
  double mean_history_weight = 0.0;    ///< average over pixels, 0 for the first frame and after a reset
  std::vector<gpu::PassTime> passes;   ///< device time, in order of execution
};

struct Denoised {
  Frame frame;  ///< beauty, the remaining variance, and the diagnostics asked for
  FrameReport report;
};

/// AOVs that the filter uses when a frame has them; what else a frame carries is ignored.
AovSet wanted_aovs(const Settings& settings);

/// Denoises a sequence forward in time: every frame is aligned with the history of the frames before it and merged.
/// One frame out for each frame in, in the same order. All frames have the size given at construction, and the AOVs
/// that the first frame had; a frame that lacks one throws Error(bad_input).
class ForwardFilter {
 public:
  /// Builds the chains for this size. Throws Error(resource) or gpu::DeviceError if the device cannot hold them.
  ForwardFilter(gpu::Device& device, const Settings& settings, int width, int height, AovSet available,
                AovSet diagnostics = {});
  ~ForwardFilter();
  ForwardFilter(ForwardFilter&&) noexcept;

  Denoised denoise(const Frame& frame);

  /// Forgets the history: the next frame starts anew, as after a cut or a missing frame.
  void reset();

  /// Bytes of device memory that the chains hold, and what they would hold without aliasing.
  std::uint64_t device_bytes() const;
  std::uint64_t device_bytes_unaliased() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::filter
