#pragma once

#include <array>
#include <memory>
#include <optional>

#include "filter/gpu/device.h"
#include "filter/report.h"
#include "filter/sequence/frame_filter.h"
#include "filter/sequence/schedule.h"
#include "filter/settings.h"
#include "frame/frame.h"

namespace becalm::filter {

/// Denoises a sequence of pairs of frames, one of each eye: each eye by a SequenceFilter of its own, whose
/// merged estimates are combined before they are smoothed for the output (Philippi et al., section 4.1).
/// Nothing of the other eye enters an eye's history, so that both stay independent from frame to frame.
class StereoFilter {
 public:
  template <class T>
  using Pair = std::array<T, 2>;

  /// As SequenceFilter. Both eyes have the size and the AOVs of `available`.
  StereoFilter(gpu::Device& device, const Settings& settings, int width, int height, AovSet available,
               const SequenceOptions& options = {});
  ~StereoFilter();
  StereoFilter(StereoFilter&&) noexcept;

  /// Runs one step of a schedule with both eyes' frames. Either eye may come first, but the same one in all
  /// steps. A wanted forward step returns both filtered frames. Frames with a known stereo camera
  /// (Frame::stereo) and depth are aligned by depth, others by the search.
  Pair<std::optional<Frame>> run(const Step& step, const Pair<const Frame*>& eyes,
                                 Pair<FrameReport>& reports);
  FilterMemory memory() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::filter
