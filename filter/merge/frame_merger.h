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

/// What is made of a new frame. Images that are empty nobody wants.
struct MergedFrame {
  Estimate merged;      ///< the history and the frame
  Estimate prediction;  ///< the history alone, where the frame's pixels are; its squared bias, as this frame
                        ///< showed it, is part of the variance
  Image decision;       ///< four channels, as MergeOutputs::decision
  Image residual;       ///< one channel: patch distance of the finest level
  Image flow;           ///< two channels: where in the history each pixel was found, as an offset in pixels
};

/// Merges new frames with the history that it keeps. A frame that the device can hold is one tile, whose
/// history stays on the device. Others are cut: the coarse levels are searched for the whole frame at once,
/// the finer ones and the merge run tile after tile, and the history is on the host. Tiles see so much around
/// them that the results do not show them.
class FrameMerger {
 public:
  /// Chooses the largest tiles whose chains hold at most `memory_limit` bytes on the device. Throws
  /// DeviceLimitError if not even the smallest do.
  FrameMerger(gpu::Device& device, FilterTask task, std::uint64_t memory_limit);
  ~FrameMerger();

  /// Adds to the report how many variances were replaced, and the device times.
  void merge(const NewFrame& frame, MergedFrame& merged, FrameReport& report);
  /// Forgets the history.
  void reset();
  FilterMemory memory() const;

 private:
  struct Chains;
  struct Host;
  bool plan_whole_frame(gpu::Device& device, std::uint64_t memory_limit);
  void plan_tiles_of_frame(gpu::Device& device, std::uint64_t memory_limit);
  void find_features(const Tile& tile, const NewFrame& frame, FrameReport& report);
  void find_coarse_offsets(const NewFrame& frame, FrameReport& report);
  void upload_cut(const Tile& tile);
  void merge_tile(const Tile& tile, const NewFrame& frame, MergedFrame& merged, FrameReport& report);

  FilterTask task_;
  std::vector<Tile> tiles_;
  std::vector<Tile> feature_tiles_;  ///< of which features are made, if the frame is cut
  std::unique_ptr<Chains> chains_;
  std::unique_ptr<Host> host_;  ///< of a frame that is cut: what goes from one frame to the next
  Image albedo_;                ///< of the new frame, as pack_albedo gives it, if the merge asks
  Image previous_albedo_;
};

}  // namespace becalm::filter
