#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/gpu/profiler.h"

namespace becalm::filter {

/// Counts, averages and times of one filtered frame.
struct FrameReport {
  /// Pixels with NaN or Inf in the beauty, which are passed through unchanged.
  std::size_t non_finite_pixels = 0;
  /// Pixels with NaN or Inf in a guide that is used (albedo, normal, depth), except for infinite depths,
  /// which mean that nothing was hit. Counted in wanted forward steps; input/host_images.h says what replaces
  /// them.
  std::size_t non_finite_guides = 0;
  /// Variances that were negative or not finite, replaced by the squared luminance (100 % noise).
  std::size_t replaced_variances = 0;
  /// Non-finite values of additive AOVs in pixels with a finite beauty, replaced by 0.
  std::size_t replaced_additive = 0;
  /// Pixels whose motion exceeds motion_limit_px and is ignored.
  std::size_t far_motions = 0;
  /// The frame's noise_ratio() (input/noise_ratio.h); 1 if the filter does not smooth.
  float noise_ratio = 1.0f;
  /// A cut was found between this frame and the previous one in this direction.
  bool new_shot = false;
  /// Rejected share of the history, averaged over pixels.
  double mean_rejected = 0.0;
  /// Effective number of frames per pixel, averaged over pixels.
  double mean_sample_count = 0.0;
  /// Device time of each pass, summed over tiles, in order of execution.
  std::vector<gpu::PassTime> passes;
};

/// Adds the pass times of a chain's last run to the report, summed by pass name.
void add_times(FrameReport& report, const gpu::Chain& chain);

/// The tiles, and the memory held for them.
struct FilterMemory {
  std::size_t tiles = 1;
  gpu::Extent tile;       ///< size of a tile's target rectangle
  std::string tile_plan;  ///< as describe() of tiles/tiles.h
  gpu::DeviceBytes device = {};
  std::uint64_t device_bytes_unaliased = 0;  ///< if images did not share memory
  std::uint64_t staging_bytes = 0;           ///< host memory for uploads and downloads

  /// Adds the bytes of a part, but not its tiles.
  FilterMemory& operator+=(const FilterMemory& part);
};

/// Adds the memory that a chain holds.
void add_memory(FilterMemory& memory, const gpu::Chain& chain);

/// Adds the bytes of a part that has tiles of its own, and its plan under `name` if it is cut.
void add_memory(FilterMemory& memory, const FilterMemory& part, const std::string& name);

}  // namespace becalm::filter
