#include "filter/merge/statistics.h"

namespace becalm::filter {

MergeStatistics add_statistics(gpu::Chain& chain, gpu::Extent full, gpu::ImageId color, gpu::ImageId variance,
                               const WarpedHistory& warped, gpu::ImageId exposure) {
  const MergeStatistics statistics{.difference = chain.image("difference", gpu::Format::f32x4, full),
                                   .noise = chain.image("noise", gpu::Format::f32x4, full)};
  chain.pass("merge/statistics")
      .read("color", color)
      .read("variance", variance)
      .read("warped_color", warped.color)
      .read("warped_stats", warped.stats)
      .read("exposure", exposure)
      .write("difference", statistics.difference)
      .write("noise", statistics.noise)
      .dispatch(full);
  return statistics;
}

}  // namespace becalm::filter
