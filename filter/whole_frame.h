#pragma once

#include <optional>

#include "filter/frame_merger.h"
#include "filter/gpu/chain.h"
#include "filter/merge.h"

namespace becalm::filter {

/// The filter for frames that the device holds whole: one chain, and the history stays on the device.
class WholeFrame : public FrameMerger {
 public:
  /// Plans the chain, so that `memory` tells what it will take. Throws DeviceLimitError if the device cannot
  /// bind or hold its images.
  WholeFrame(gpu::Device& device, FilterTask task);
  /// Makes what the chain needs to run; before the first frame. Throws DeviceError if memory is lacking.
  void build() { chain_.build(); }

  void merge(const NewFrame& frame, MergedFrame& merged, FrameReport& report) override;
  void reset() override { chain_.reset_history(); }
  FilterMemory memory() const override;

 private:
  FilterTask task_;
  gpu::Chain chain_;
  gpu::ImageId color_;
  gpu::ImageId exposure_;
  gpu::ImageId variance_;
  std::optional<gpu::ImageId> guide_;
  std::optional<gpu::ImageId> motion_;
  std::optional<gpu::ImageId> half_difference_;
  gpu::ImageId offset_;
  gpu::ImageId merged_color_;
  gpu::ImageId merged_stats_;
  MergeOutputs outputs_;
};

}  // namespace becalm::filter
