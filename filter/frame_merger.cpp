#include "filter/frame_merger.h"

#include <algorithm>

#include "filter/ceil_div.h"
#include "filter/host_images.h"
#include "filter/pixel_view.h"

namespace becalm::filter {

Estimate::Estimate(gpu::Extent extent, std::size_t carried_count)
    : color(extent.width, extent.height, 4),
      stats(extent.width, extent.height, 2),
      additive(carried_count, color) {}

void copy_core(std::span<const float> pixels, const Tile& tile, Image& image) {
  if (image.empty()) return;
  copy_rect({pixels, tile.target.extent(), image.channels()}, within(tile.core, tile.target), view(image),
            tile.core.x, tile.core.y);
}

void copy_core(const std::vector<std::span<const float>>& pixels, const Tile& tile,
               std::vector<Image>& images) {
  for (std::size_t i = 0; i < images.size(); ++i) copy_core(pixels[i], tile, images[i]);
}

void unpack(const MergedTile& tile_images, const Tile& tile, MergedFrame& frame) {
  copy_core(tile_images.color, tile, frame.merged.color);
  copy_core(tile_images.stats, tile, frame.merged.stats);
  copy_core(tile_images.warped_color, tile, frame.prediction.color);
  copy_core(tile_images.warped_stats, tile, frame.prediction.stats);
  copy_core(tile_images.additive, tile, frame.merged.additive);
  copy_core(tile_images.warped_additive, tile, frame.prediction.additive);
  copy_core(tile_images.offset, tile, frame.flow);
  copy_core(tile_images.decision, tile, frame.decision);
  const Rect& core = tile.core;
  const int residual_width = ceil_div(tile.target.width, tile_images.residual_px);
  for (int y = core.y; y < core.y + core.height; ++y) {
    std::size_t t =
        static_cast<std::size_t>(y - tile.target.y) * tile.target.width + (core.x - tile.target.x);
    for (int x = core.x; x < core.x + core.width; ++x, ++t) {
      if (!frame.prediction.stats.empty()) {
        float& variance = frame.prediction.stats.at(x, y, 0);
        variance = std::min(variance + tile_images.decision[4 * t + 1], kLargestVariance);
      }
      if (!frame.residual.empty()) {
        const int column = (x - tile.target.x) / tile_images.residual_px;
        const int row = (y - tile.target.y) / tile_images.residual_px;
        frame.residual.at(x, y, 0) =
            tile_images.residual[static_cast<std::size_t>(row) * residual_width + column];
      }
    }
  }
}

void add_times(FrameReport& report, const gpu::Chain& chain) {
  for (const gpu::PassTime& pass : chain.times()) {
    const auto same = std::ranges::find(report.passes, pass.name, &gpu::PassTime::name);
    if (same == report.passes.end()) {
      report.passes.push_back(pass);
    } else {
      same->milliseconds += pass.milliseconds;
    }
  }
}

void add_memory(FilterMemory& memory, const gpu::Chain& chain) {
  memory.device_bytes += chain.device_bytes();
  memory.device_bytes_unaliased += chain.device_bytes_unaliased();
  memory.staging_bytes += chain.staging_bytes();
}

}  // namespace becalm::filter
