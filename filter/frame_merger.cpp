#include "filter/frame_merger.h"

#include <algorithm>

namespace becalm::filter {

void unpack(const MergedTile& merged, const Tile& tile, const NewFrame& frame, Denoised& result) {
  const Rect& core = tile.core;
  const std::span<const float> beauty = frame.frame.image(Aov::beauty).data();
  const std::span<float> out = result.frame.image(Aov::beauty).data();
  const std::span<float> variance = result.frame.image(Aov::variance).data();
  // Empty where nobody asked.
  const std::span<float> mask = result.frame.image(Aov::error_mask).data();
  const std::span<float> count = result.frame.image(Aov::sample_count).data();
  const std::span<float> flow = result.frame.image(Aov::flow).data();
  for (int y = core.y; y < core.y + core.height; ++y) {
    std::size_t i = static_cast<std::size_t>(y) * result.frame.width() + core.x;
    std::size_t t =
        static_cast<std::size_t>(y - tile.target.y) * tile.target.width + (core.x - tile.target.x);
    for (const std::size_t end = i + core.width; i < end; ++i, ++t) {
      const auto pixel = frame.finite[i] ? merged.color.subspan(4 * t, 4) : beauty.subspan(4 * i, 4);
      std::ranges::copy(pixel, out.begin() + 4 * i);
      std::ranges::fill_n(variance.begin() + 3 * i, 3, merged.stats[2 * t]);
      if (!mask.empty()) mask[i] = merged.decision[2 * t];
      if (!count.empty()) count[i] = merged.decision[2 * t + 1];
      if (!flow.empty()) std::ranges::copy(merged.offset.subspan(2 * t, 2), flow.begin() + 2 * i);
      result.report.mean_rejected += merged.decision[2 * t];
      result.report.mean_sample_count += merged.decision[2 * t + 1];
    }
  }
}

}  // namespace becalm::filter
