#include "filter/frame_smoother.h"

#include <string>
#include <utility>
#include <vector>

#include "filter/additive.h"
#include "filter/correct.h"
#include "filter/estimate_variance.h"
#include "filter/host_images.h"
#include "filter/noisy_inputs.h"
#include "filter/smooth.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

struct FrameSmoother::SmoothChain {
  SmoothChain(gpu::Device& device, const FilterTask& task, Extent extent)
      : chain(device, "smooth"),
        noisy(chain, task, extent, true),
        additive(additive_inputs(chain, task, extent, "additive.cur")) {
    const Smoothed smoothed =
        add_smooth_passes(chain, task.settings, extent, noisy, *noisy.features, additive);
    color = smoothed.color;
    smoothed_additive = smoothed.additive;
    stats = smoothed.stats;
    if (task.settings.correct_levels > 0) {
      Corrected corrected = add_correction_passes(chain, task.settings, extent,
                                                  {.color = noisy.color,
                                                   .variance = noisy.variance,
                                                   .exposure = noisy.exposure,
                                                   .half_difference = noisy.half_difference,
                                                   .estimate = color,
                                                   .estimate_stats = stats,
                                                   .additive = std::move(smoothed_additive)},
                                                  "correction");
      color = corrected.estimate;
      smoothed_additive = std::move(corrected.additive);
    }
    chain.output(color);
    chain.output(stats);
    for (const ImageId image : smoothed_additive) chain.output(image);
    chain.plan();
  }

  gpu::Chain chain;
  NoisyInputs noisy;
  std::vector<ImageId> additive;
  ImageId color;
  ImageId stats;
  std::vector<ImageId> smoothed_additive;
};

FrameSmoother::FrameSmoother(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit)
    : task_(task) {
  const int margin =
      smooth_margin_px(task.settings) + correction_margin_px(task.settings) + kVarianceEstimateMargin;
  const int grid = correction_grid_px(task.settings);
  const TileRules rules{
      .grid = grid, .core_grid = grid, .left = margin, .above = margin, .after = margin, .reach = 0};
  std::string reason;
  tiles_ = plan_tiles(task.full, rules, [&](const Tile& tile) {
    try {
      chain_ = std::make_unique<SmoothChain>(device, task, tile.target.extent());
    } catch (const gpu::DeviceLimitError& error) {
      reason = error.what();
      return false;
    }
    const std::uint64_t bytes = chain_->chain.device_bytes();
    reason = tiles_too_large(tile, bytes, memory_limit);
    return bytes <= memory_limit;
  });
  if (tiles_.empty()) throw cannot_be_cut(task.full, reason);
  chain_->chain.build();
}

FrameSmoother::~FrameSmoother() = default;

Estimate FrameSmoother::smooth(const NewFrame& frame, FrameReport& report) {
  Estimate result(task_.full, task_.additive);
  gpu::Chain& chain = chain_->chain;
  FrameReport ignored;  // what is replaced is counted where the frame is merged
  for (const Tile& tile : tiles_) {
    chain_->noisy.upload(chain, task_, frame, tile, ignored);
    upload_additive(chain, chain_->additive, frame.additive, tile.target);
    chain.run();
    add_times(report, chain);
    copy_core(chain.download<float>(chain_->color), tile, result.color);
    copy_core(chain.download<float>(chain_->stats), tile, result.stats);
    copy_core(download_additive(chain, chain_->smoothed_additive), tile, result.additive);
  }
  return result;
}

FilterMemory FrameSmoother::memory() const {
  return {.tiles = tiles_.size(),
          .tile = tiles_.front().target.extent(),
          .device_bytes = chain_->chain.device_bytes(),
          .device_bytes_unaliased = chain_->chain.device_bytes_unaliased(),
          .staging_bytes = chain_->chain.staging_bytes()};
}

}  // namespace becalm::filter
