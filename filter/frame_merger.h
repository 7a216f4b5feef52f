#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/gpu/profiler.h"
#include "filter/guides.h"
#include "filter/settings.h"
#include "filter/tiles.h"
#include "frame/frame.h"

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

struct Denoised {
  Frame frame;  ///< beauty, the variance left, additive AOVs, and the diagnostics asked for
  FrameReport report;
};

/// What a filter is built for.
struct FilterTask {
  Settings settings;
  gpu::Extent full;
  AovSet used;         ///< what is read of a frame besides the beauty
  AovSet diagnostics;  ///< those that are wanted
  Guides guides;
  std::size_t additive = 0;  ///< how many additive AOVs frames have (additive.h)
  bool merged = false;       ///< frames are merged ones: they have NewFrame::own

  bool has_halves() const { return contains(used, Aov::half_a) && contains(used, Aov::half_b); }
  bool variance_known() const { return contains(used, Aov::variance) || has_halves(); }
  /// In variance mode alone: history that is never rejected would go on multiplying by noisy albedo.
  bool demodulates_history() const {
    return contains(used, Aov::albedo) && settings.merge == MergeMode::variance;
  }
  bool smooths() const { return settings.smooth != Smooth::none; }
  /// Whether smoothed frames only decide the weights by which noisy ones are merged, and what comes out is
  /// smoothed.
  bool smooths_merged() const { return settings.smooth == Smooth::merged; }
  /// Images that are merged with the beauty's weights: additive AOVs, then what is smoothed once it is
  /// merged.
  std::size_t carried() const { return additive + (smooths_merged() ? kNoisyLayers : 0); }

  /// Noisy radiance with its variance; albedo with depth; normal.
  static constexpr std::size_t kNoisyLayers = 3;
};

/// What is known of a frame's pixels, and how well.
struct Estimate {
  Estimate() = default;
  Estimate(gpu::Extent extent, std::size_t carried_count);

  Image color;  ///< four channels
  Image stats;  ///< (variance, effective sample count); a count of 0 where nothing is known
  /// What goes with the beauty's weights, four channels each: additive AOVs; in the merge also the noisy
  /// layers, if the task smooths what is merged.
  std::vector<Image> additive;
};

/// A frame on its way into the chains.
struct NewFrame {
  const Frame& frame;
  const NewFrame* own = nullptr;     ///< of merged frames, the one itself
  std::vector<std::uint8_t> finite;  ///< of finite_pixels
  float exposure;                    ///< of the whole frame
  float usual_depth = 1.0f;          ///< of typical_depth
  std::vector<Image> additive = {};  ///< of pack_additive
  Estimate smoothed = {};            ///< what is matched and merged in place of the frame, if not empty

  const std::vector<Image>& merged_additive() const {
    return smoothed.additive.empty() ? additive : smoothed.additive;
  }
};

/// The noisy layers that an estimate carries, as images of an AOV's channels.
struct Accumulated {
  Image color;     ///< RGB
  Image variance;  ///< Y: of a frame over the effective number of frames
  Image albedo;    ///< RGB
  Image normal;    ///< XYZ
  Image depth;     ///< Y: of pack_features, in [0,2]
};

/// What a merger makes of a new frame. Images that are empty nobody wants.
struct MergedFrame {
  Estimate merged;      ///< the history and the frame
  Estimate prediction;  ///< the history alone, where the frame's pixels are; its squared bias, as this frame
                        ///< showed it, is part of the variance
  Image decision;       ///< four channels, as MergeOutputs::decision
  Image residual;       ///< one channel: patch distance of the finest level
  Accumulated accumulated;  ///< if that is a diagnostic that is wanted
  Image flow;  ///< two channels: where in the history each pixel was found, as an offset in pixels
};

/// What a chain made of one tile's target rectangle; spans of what nobody wants may be empty.
struct MergedTile {
  std::span<const float> color;
  std::span<const float> stats;
  std::span<const float> warped_color;
  std::span<const float> warped_stats;
  std::vector<std::span<const float>> additive;         ///< as `color`
  std::vector<std::span<const float>> warped_additive;  ///< as `warped_color`
  std::span<const float> decision;
  std::span<const float> offset;
  std::span<const float> residual;  ///< of the finest level
  int residual_px = 1;              ///< full-resolution pixels in one of the level's
};

/// Copies the core of a tile's pixels into a frame's image, if that is not empty.
void copy_core(std::span<const float> pixels, const Tile& tile, Image& image);
void copy_core(const std::vector<std::span<const float>>& pixels, const Tile& tile,
               std::vector<Image>& images);

/// Puts a tile's core where it belongs in those images of the frame that are wanted.
void unpack(const MergedTile& tile_images, const Tile& tile, MergedFrame& frame);

/// Adds the device times of a chain's last run to those of the same passes.
void add_times(FrameReport& report, const gpu::Chain& chain);

/// How the frame is cut, and what the device holds for it.
struct FilterMemory {
  std::size_t tiles = 1;
  gpu::Extent tile;  ///< what a tile sees of the new frame
  std::uint64_t device_bytes = 0;
  std::uint64_t device_bytes_unaliased = 0;  ///< if no images shared memory
  std::uint64_t staging_bytes = 0;           ///< of host memory through which images come and go
};

/// Adds what a chain holds.
void add_memory(FilterMemory& memory, const gpu::Chain& chain);

/// Merges new frames with the history that it keeps.
class FrameMerger {
 public:
  virtual ~FrameMerger() = default;
  /// Adds to the report how many variances were replaced, and the device times.
  virtual void merge(const NewFrame& frame, MergedFrame& merged, FrameReport& report) = 0;
  /// Forgets the history.
  virtual void reset() = 0;
  virtual FilterMemory memory() const = 0;
};

}  // namespace becalm::filter
