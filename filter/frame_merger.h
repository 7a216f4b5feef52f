#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/gpu/profiler.h"
#include "filter/guides.h"
#include "filter/settings.h"
#include "filter/tiles.h"
#include "frame/frame.h"

namespace becalm::filter {

/// What happened to one frame.
struct FrameReport {
  std::size_t non_finite_pixels = 0;  ///< pixels with NaN or Inf in the beauty: passed through as they came
  std::size_t replaced_variances =
      0;                              ///< variances that were not finite or negative, taken as 100 % of noise
  double mean_rejected = 0.0;         ///< share of the history that was rejected, averaged over pixels
  double mean_sample_count = 0.0;     ///< effective number of frames in a pixel, averaged over pixels
  std::vector<gpu::PassTime> passes;  ///< device time, in order of execution; of a pass in all tiles together
};

struct Denoised {
  Frame frame;  ///< beauty, the variance left, and the diagnostics asked for
  FrameReport report;
};

/// What a filter is built for.
struct FilterTask {
  Settings settings;
  gpu::Extent full;
  AovSet used;         ///< what is read of a frame besides the beauty
  AovSet diagnostics;  ///< those that are wanted
  Guides guides;

  bool has_halves() const { return contains(used, Aov::half_a) && contains(used, Aov::half_b); }
  bool variance_known() const { return contains(used, Aov::variance) || has_halves(); }
  /// Whether chains have the difference of the half-buffers as an input.
  bool needs_half_difference() const { return has_halves() && settings.correct_levels > 0; }
};

/// A frame on its way into the chains.
struct NewFrame {
  const Frame& frame;
  std::vector<std::uint8_t> finite;  ///< of finite_pixels
  float exposure;                    ///< of the whole frame
};

/// What a chain made of one tile's target rectangle.
struct MergedTile {
  std::span<const float> color;
  std::span<const float> stats;
  std::span<const float> decision;
  std::span<const float> offset;    ///< empty if nobody wants it, as is the next
  std::span<const float> residual;  ///< of the finest level
  int residual_px;                  ///< full-resolution pixels in one of the level's
};

/// Puts a tile's core into the result, whose images are there already, and adds it to the sums of the report.
void unpack(const MergedTile& merged, const Tile& tile, const NewFrame& frame, Denoised& result);

/// How the frame is cut, and what the device holds for it.
struct FilterMemory {
  std::size_t tiles = 1;
  gpu::Extent tile;  ///< what a tile sees of the new frame
  std::uint64_t device_bytes = 0;
  std::uint64_t device_bytes_unaliased = 0;  ///< if no images shared memory
  std::uint64_t staging_bytes = 0;           ///< of host memory through which images come and go
};

/// Merges new frames with the history that it keeps.
class FrameMerger {
 public:
  virtual ~FrameMerger() = default;
  virtual void merge(const NewFrame& frame, Denoised& result) = 0;
  /// Forgets the history.
  virtual void reset() = 0;
  virtual FilterMemory memory() const = 0;
};

}  // namespace becalm::filter
