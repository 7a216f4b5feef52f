#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/gpu/profiler.h"

namespace becalm::filter {

/// What happened to one frame.
struct FrameReport {
  std::size_t non_finite_pixels = 0;  ///< pixels with NaN or Inf in the beauty: passed through as they came
  /// Variances that were not finite or negative, taken as 100 % of noise.
  std::size_t replaced_variances = 0;
  /// Values of additive AOVs that were not finite where the beauty was, taken as 0.
  std::size_t replaced_additive = 0;
  std::size_t far_motions = 0;  ///< pixels whose known motion is beyond motion_limit_px and is not followed
  bool new_shot = false;       ///< a cut was found between this frame and the one before it in this direction
  double mean_rejected = 0.0;  ///< share of the history that was rejected, averaged over pixels
  double mean_sample_count = 0.0;     ///< effective number of frames in a pixel, averaged over pixels
  std::vector<gpu::PassTime> passes;  ///< device time, in order of execution; of a pass in all tiles together
};

/// Adds the device times of a chain's last run to those of the same passes.
void add_times(FrameReport& report, const gpu::Chain& chain);

/// How frames are cut, and what the device holds for them.
struct FilterMemory {
  std::size_t tiles = 1;
  gpu::Extent tile;  ///< what a tile sees of the new frame
  std::uint64_t device_bytes = 0;
  std::uint64_t device_bytes_unaliased = 0;  ///< if no images shared memory
  std::uint64_t staging_bytes = 0;           ///< of host memory through which images come and go
};

/// Adds what a chain holds.
void add_memory(FilterMemory& memory, const gpu::Chain& chain);

}  // namespace becalm::filter
