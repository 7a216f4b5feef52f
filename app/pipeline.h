#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "frame/frame.h"
#include "frame/io/exr.h"

namespace becalm::app {

/// A frame at the end of the pipeline, and the noisy one that it was made from.
struct FinishedFrame {
  Frame frame;
  /// Of a stereo file, in the order of the source's; then that of the other eye's file.
  std::vector<Frame> other_views;
  io::LoadedFrame source;
  /// Of each view: the mean relative squared error that the filter expects; empty unless asked for.
  std::vector<double> expected_errors = {};
};

/// What a command does with frames. Each stage is called in the order of the steps.
struct Stages {
  /// Optional: what must be done once before the first frame is filtered, while the source makes that. On the
  /// caller's thread.
  std::function<void()> prepare = {};
  /// The noisy frame of a step, rendered or read; nothing if a stop was requested. On threads of its own.
  std::function<std::optional<io::LoadedFrame>(std::size_t step)> source;
  /// Nothing where a step makes no frame. On the caller's thread.
  std::function<std::optional<FinishedFrame>(std::size_t step, io::LoadedFrame noisy)> filter;
  /// Writes a frame. On threads of its own.
  std::function<void(FinishedFrame frame)> sink;
};

/// When the source is asked for step n, the outputs of step n - kStepsUnderWay and of all earlier ones have
/// been written.
inline constexpr std::size_t kStepsUnderWay = 3;

/// Takes frames from the source through the filter to the sink until a stop is requested: while the filter
/// works on one frame, the source makes the next one and the sink writes the last one, so that memory holds
/// three. When a stage throws, a stop is requested, frames that left the filter are still written, and the
/// exception is thrown on.
void run_pipeline(std::size_t steps, const Stages& stages);

/// The filter of a command that has none: the beauty as it is. The other AOVs stay in the source.
FinishedFrame unfiltered(io::LoadedFrame noisy);

}  // namespace becalm::app
