#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "filter/gpu/device.h"
#include "filter/gpu/profiler.h"
#include "filter/settings.h"
#include "frame/frame.h"

namespace becalm::filter {

/// What happened to one frame.
struct FrameReport {
  std::size_t non_finite_pixels = 0;  ///< pixels with NaN or Inf in the beauty: passed through as they came
  std::size_t replaced_variances =
      0;                              ///< variances that were not finite or negative, taken as 100 % of noise
  double mean_rejected = 0.0;         ///< share of the history that was rejected, averaged over pixels
  double mean_sample_count = 0.0;     ///< effective number of frames in a pixel, averaged over pixels
  std::vector<gpu::PassTime> passes;  ///< device time, in order of execution
};

struct Denoised {
  Frame frame;  ///< beauty, the variance left, and the diagnostics asked for
  FrameReport report;
};

/// AOVs that the filter uses when a frame has them; what else a frame carries is ignored.
AovSet wanted_aovs(const Settings& settings);

/// Denoises a sequence forward in time: every frame is aligned with the history of the frames before it and
/// merged. One frame out for each frame in, in the same order. All frames have the size given at construction
/// and the AOVs of `available` that the filter wants; a frame that differs throws Error(bad_input).
class ForwardFilter {
 public:
  /// Builds the chain for this size. `diagnostics` are those of flow, error_mask and sample_count to put into
  /// the results. Throws gpu::DeviceError if the device cannot hold the chain.
  ForwardFilter(gpu::Device& device, const Settings& settings, int width, int height, AovSet available,
                AovSet diagnostics = {});
  ~ForwardFilter();
  ForwardFilter(ForwardFilter&&) noexcept;

  Denoised denoise(const Frame& frame);

  /// Forgets the history: the next frame starts anew, as after a cut or a missing frame.
  void reset();

  /// Bytes of device memory that the chain holds, and what it would hold without aliasing.
  std::uint64_t device_bytes() const;
  std::uint64_t device_bytes_unaliased() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::filter
