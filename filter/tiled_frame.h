#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "filter/frame_merger.h"
#include "filter/pixel_view.h"
#include "filter/tile_chains.h"

namespace becalm::filter {

/// Images of a whole frame at one level of the pyramid, on the host.
struct HostPlanes {
  HostPlanes() = default;
  explicit HostPlanes(gpu::Extent size) : extent(size), values(size.elements()) {}
  PixelView<float> view() { return {values, extent}; }
  PixelView<const float> view() const { return {values, extent}; }

  gpu::Extent extent;
  std::vector<float> values;
};

/// What is matched of a whole frame.
struct HostFeatures {
  HostPlanes finest;  ///< level 0
  HostPlanes coarse;  ///< level `coarse` of the split
};

/// What is known of the frames before: all that goes from one frame to the next.
struct HostHistory {
  Estimate estimate;
  Image albedo;  ///< of the frame before, as pack_albedo gives it; empty if nobody asks
  HostFeatures
      features;  ///< those of the frame before; a new frame replaces their radiance by that of `color`
};

/// The filter for frames that the device cannot hold whole, or may not: the coarse levels are searched for
/// the whole frame at once, the finer ones and the merge run tile after tile, and the history stays on the
/// host. The result is bit for bit that of WholeFrame.
class TiledFrame : public FrameMerger {
 public:
  /// Chooses the largest tiles whose chains hold at most `memory_limit` bytes on the device. Throws
  /// DeviceLimitError if not even the smallest do.
  TiledFrame(gpu::Device& device, FilterTask task, std::uint64_t memory_limit);
  ~TiledFrame() override;

  void merge(const NewFrame& frame, MergedFrame& merged, FrameReport& report) override;
  void reset() override;
  FilterMemory memory() const override;

 private:
  struct Chains;
  void plan(gpu::Device& device, std::uint64_t memory_limit);
  void find_features(const Tile& tile, const NewFrame& frame, FrameReport& report);
  void find_coarse_offsets(const NewFrame& frame, FrameReport& report);
  void merge_tile(const Tile& tile, const NewFrame& frame, MergedFrame& merged, FrameReport& report);

  FilterTask task_;
  PyramidSplit split_;
  std::vector<Tile> tiles_;
  std::vector<Tile> feature_tiles_;  ///< of which features are made
  std::unique_ptr<Chains> chains_;
  HostHistory history_;
  HostFeatures features_;  ///< of the new frame
  Estimate merged_;        ///< the history of the next frame in the making
  Image albedo_;           ///< of the new frame
};

}  // namespace becalm::filter
