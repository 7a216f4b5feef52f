#include "filter/merge/statistics.h"

namespace becalm::filter {

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
      .read("noisy_variance", frame.noisy_variance)
      .write("difference", statistics.difference)
      .write("noise", statistics.noise)
      .specialize("knows_noisy", frame.noisy_variance ? 1 : 0)
      .dispatch(full);
  return statistics;
}

}  // namespace becalm::filter
