#include "filter/merge/statistics.h"

namespace becalm::filter {
namespace {

/// What of a difference from the history is expected, as statistics.comp numbers it.
enum class Expectation { nothing, noise, unshared_error };

Expectation expectation_of(const FrameToCompare& frame) {
  if (!frame.smoothed) return Expectation::noise;
  return frame.noisy ? Expectation::unshared_error : Expectation::nothing;
}

}  // namespace

MergeStatistics add_statistics(gpu::Chain& chain, gpu::Extent full, const FrameToCompare& frame,
                               const WarpedHistory& warped) {
  const MergeStatistics statistics{.difference = chain.image("difference", gpu::Format::f32x4, full),
                                   .noise = chain.image("noise", gpu::Format::f32x4, full)};
  chain.pass("merge/statistics")
      .read("color", frame.color)
      .read("variance", frame.variance)
      .read("warped_color", warped.color)
      .read("warped_stats", warped.stats)
      .read("exposure", frame.exposure)
      .read("noisy", frame.noisy ? std::optional(frame.noisy->image) : std::nullopt)
      .write("difference", statistics.difference)
      .write("noise", statistics.noise)
      .specialize("expectation", static_cast<int>(expectation_of(frame)))
      .specialize("noisy_channel", frame.noisy ? frame.noisy->channel : 0)
      .dispatch(full);
  return statistics;
}

}  // namespace becalm::filter
