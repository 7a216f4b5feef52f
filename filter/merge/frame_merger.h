#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "filter/estimate.h"
#include "filter/report.h"
#include "filter/task.h"
#include "filter/tiles/pixel_view.h"
#include "filter/tiles/tiles.h"

namespace becalm::filter {

/// Results of merging a new frame. The caller allocates the images that it wants, of the frame's size; those
/// that are empty are not made.
struct MergedFrame {
  Estimate merged;  ///< history and new frame, merged
  /// The history alone, warped to the new frame. Its variance includes the squared bias estimated against
  /// that frame.
  Estimate prediction;
  Image decision;         ///< four channels, as MergeOutputs::decision
  Image residual;         ///< one channel: patch distance of the finest level
  Image flow;             ///< two channels: reprojection offset into the history, in pixels
  double rejected = 0.0;  ///< sum of the rejected shares of all pixels
};

/// Merges new frames with the history that it keeps. A frame that the device can hold is one tile, and its
/// history stays on the device. Other frames are cut: the coarse levels are searched for the whole frame at
/// once, the finer levels and the merge run tile by tile, and the history is kept on the host. Tiles have
/// margins, so that the results do not depend on the cut.
class FrameMerger {
 public:
  /// Chooses the largest tiles whose chains hold at most `memory_limit` bytes on the device. Throws
  /// DeviceLimitError if even the smallest tiles hold more.
  FrameMerger(gpu::Device& device, FilterTask task, std::uint64_t memory_limit);
  ~FrameMerger();

  /// Merges a frame. Adds the number of replaced variances and the device times to the report.
  void merge(const NewFrame& frame, MergedFrame& merged, FrameReport& report);
  /// Forgets the history.
  void reset();
  FilterMemory memory() const;

 private:
  struct Chains;
  struct Host;
  void upload_guide(const NewFrame& frame, const Rect& rect, std::span<float> planes) const;
  void find_features(const Tile& tile, const NewFrame& frame, FrameReport& report);
  void find_coarse_offsets(const NewFrame& frame, FrameReport& report);
  void upload_cut(const Tile& tile);
  void merge_tile(const Tile& tile, const NewFrame& frame, MergedFrame& merged, FrameReport& report);

  FilterTask task_;
  std::vector<Tile> tiles_;
  std::vector<Tile> feature_tiles_;  ///< for making features, if the frame is cut
  std::unique_ptr<Chains> chains_;
  std::unique_ptr<Host> host_;  ///< if the frame is cut: state kept between frames
};

}  // namespace becalm::filter
