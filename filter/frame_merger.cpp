#include "filter/frame_merger.h"

#include <algorithm>
#include <cmath>

namespace becalm::filter {

void unpack(const MergedTile& merged, const Tile& tile, const NewFrame& frame, Denoised& result) {
  const Rect& core = tile.core;
  const std::span<const float> beauty = frame.frame.image(Aov::beauty).data();
  const std::span<float> out = result.frame.image(Aov::beauty).data();
  const std::span<float> variance = result.frame.image(Aov::variance).data();
  // Empty where nobody asked.
  const std::span<float> mask = result.frame.image(Aov::error_mask).data();
  const std::span<float> bias = result.frame.image(Aov::bias).data();
  const std::span<float> gain = result.frame.image(Aov::gain).data();
  const std::span<float> rule = result.frame.image(Aov::rejected_by).data();
  const std::span<float> count = result.frame.image(Aov::sample_count).data();
  const std::span<float> flow = result.frame.image(Aov::flow).data();
  const std::span<float> residual = result.frame.image(Aov::residual).data();
  const int residual_width = (tile.target.width + merged.residual_px - 1) / merged.residual_px;
  for (int y = core.y; y < core.y + core.height; ++y) {
    std::size_t i = static_cast<std::size_t>(y) * result.frame.width() + core.x;
    std::size_t t =
        static_cast<std::size_t>(y - tile.target.y) * tile.target.width + (core.x - tile.target.x);
    for (const std::size_t end = i + core.width; i < end; ++i, ++t) {
      const auto pixel = frame.finite[i] ? merged.color.subspan(4 * t, 4) : beauty.subspan(4 * i, 4);
      std::ranges::copy(pixel, out.begin() + 4 * i);
      std::ranges::fill_n(variance.begin() + 3 * i, 3, merged.stats[2 * t]);
      const auto decision = merged.decision.subspan(4 * t, 4);
      if (!mask.empty()) mask[i] = decision[0];
      if (!bias.empty()) bias[i] = std::sqrt(decision[1]);
      if (!gain.empty()) gain[i] = decision[2];
      if (!rule.empty()) rule[i] = decision[3];
      if (!count.empty()) count[i] = merged.stats[2 * t + 1];
      if (!flow.empty()) std::ranges::copy(merged.offset.subspan(2 * t, 2), flow.begin() + 2 * i);
      if (!residual.empty()) {
        const int column = (static_cast<int>(i) % result.frame.width() - tile.target.x) / merged.residual_px;
        const int row = (y - tile.target.y) / merged.residual_px;
        residual[i] = merged.residual[static_cast<std::size_t>(row) * residual_width + column];
      }
      result.report.mean_rejected += decision[0];
      result.report.mean_sample_count += merged.stats[2 * t + 1];
    }
  }
}

}  // namespace becalm::filter
