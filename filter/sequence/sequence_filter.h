#pragma once

#include <memory>
#include <optional>

#include "filter/estimate.h"
#include "filter/gpu/device.h"
#include "filter/merge/frame_merger.h"
#include "filter/report.h"
#include "filter/sequence/frame_filter.h"
#include "filter/settings.h"
#include "filter/task.h"
#include "frame/frame.h"

namespace becalm::filter {

/// AOVs that the filter uses if a frame has them, besides the additive ones (merge/additive.h), which it
/// denoises where it is told that they are available. Other AOVs are ignored.
AovSet wanted_aovs(const Settings& settings);

/// Denoises a sequence: every frame is aligned with the history of the frames before it (in backward steps,
/// of those after it) and merged. All frames have the size given at construction and the AOVs of `available`
/// that the filter wants; a frame that differs throws Error(bad_input).
class SequenceFilter : public FrameFilter {
 public:
  /// Builds the chains for this size. Throws gpu::DeviceError if even the smallest tiles are too large.
  SequenceFilter(gpu::Device& device, const Settings& settings, int width, int height, AovSet available,
                 const SequenceOptions& options = {});
  ~SequenceFilter() override;
  SequenceFilter(SequenceFilter&&) noexcept;

  /// Wanted forward steps return beauty, remaining variance, additive AOVs, and the diagnostics.
  /// A smoothed frame is kept until its last step and takes some 12 bytes per pixel, with its albedo 6 more,
  /// with smooth=frames 16 more for each additive AOV. A prediction is kept from the backward step to the
  /// forward step of its frame and takes 12, with smooth=merged 24 more, and 16 for each additive AOV.
  std::optional<Frame> run(const Step& step, const Frame& frame, FrameReport& report) override;

  /// A frame between its merge and what comes out.
  struct Merged {
    NewFrame frame;
    MergedFrame made;
  };

  /// `run` in two halves, between which the estimate of a wanted forward step may be improved: what `begin`
  /// returns (nothing in other steps) refers to `frame`, which must live until `finish`.
  std::optional<Merged> begin(const Step& step, const Frame& frame, FrameReport& report);
  Frame finish(Merged& merged, FrameReport& report);
  /// What the frame's chains are built for.
  const FilterTask& task() const;

  /// The merge's tiles, and the device memory held by all chains. The tile plan is `1` if no chain cuts the
  /// frame; else it names each chain that does.
  FilterMemory memory() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::filter
