#pragma once

#include <optional>
#include <vector>

#include "filter/frame_merger.h"
#include "filter/gpu/chain.h"
#include "filter/merge.h"
#include "filter/merged_images.h"
#include "filter/noisy_inputs.h"

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
  NoisyInputs noisy_;
  gpu::ImageId smoothed_color_;  ///< if the task smooths
  gpu::ImageId smoothed_stats_;
  std::optional<gpu::ImageId> guide_;
  std::optional<gpu::ImageId> motion_;
  std::optional<FramePair> albedo_;
  std::vector<gpu::ImageId> additive_;
  MergedImages merged_;
};

}  // namespace becalm::filter
