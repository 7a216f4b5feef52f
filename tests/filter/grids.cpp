#include "tests/filter/grids.h"

#include <algorithm>

namespace becalm::filter {

void upload_estimate(gpu::Chain& chain, gpu::ImageId color, gpu::ImageId stats,
                     const reference::Grid<reference::Estimate>& estimate) {
  const auto colors = chain.upload<float>(color);
  const auto pairs = chain.upload<float>(stats);
  for (std::size_t i = 0; i < estimate.data.size(); ++i) {
    std::ranges::copy(estimate.data[i].color, colors.begin() + 4 * i);
    pairs[2 * i] = static_cast<float>(estimate.data[i].variance);
    pairs[2 * i + 1] = static_cast<float>(estimate.data[i].count);
  }
}

void upload_offset(gpu::Chain& chain, gpu::ImageId image, const reference::Grid<reference::Vec2>& offset) {
  const auto offsets = chain.upload<float>(image);
  for (std::size_t i = 0; i < offset.data.size(); ++i) {
    offsets[2 * i] = static_cast<float>(offset.data[i].x);
    offsets[2 * i + 1] = static_cast<float>(offset.data[i].y);
  }
}

reference::Grid<reference::Estimate> download_estimate(const gpu::Chain& chain, gpu::ImageId color,
                                                       gpu::ImageId stats, gpu::Extent extent) {
  const auto colors = chain.download<float>(color);
  const auto pairs = chain.download<float>(stats);
  reference::Grid<reference::Estimate> estimate(extent.width, extent.height);
  for (std::size_t i = 0; i < estimate.data.size(); ++i) {
    reference::Estimate& e = estimate.data[i];
    std::copy_n(colors.begin() + 4 * i, 4, e.color.begin());
    e.variance = pairs[2 * i];
    e.count = pairs[2 * i + 1];
  }
  return estimate;
}

}  // namespace becalm::filter
