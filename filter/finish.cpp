#include "filter/finish.h"

#include <string>

#include "filter/additive.h"
#include "filter/combine.h"
#include "filter/pixel_view.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

FinishChain::FinishChain(gpu::Device& device, const FilterTask& task, Extent extent)
    : chain(device, "finish") {
  exposure = chain.input("exposure", Format::f32, {1, 1});
  forward_color = chain.input("forward.color", Format::f32x4, extent);
  forward_stats = chain.input("forward.stats", Format::f32x2, extent);
  prediction_color = chain.input("prediction.color", Format::f32x4, extent);
  prediction_stats = chain.input("prediction.stats", Format::f32x2, extent);
  forward_additive = additive_inputs(chain, task, extent, "forward.additive");
  prediction_additive = additive_inputs(chain, task, extent, "prediction.additive");
  const Combined combined = add_combine_passes(chain, task.settings, extent,
                                               {.exposure = exposure,
                                                .forward_color = forward_color,
                                                .forward_stats = forward_stats,
                                                .backward_color = prediction_color,
                                                .backward_stats = prediction_stats,
                                                .forward_additive = forward_additive,
                                                .backward_additive = prediction_additive});
  color = combined.color;
  stats = combined.stats;
  additive = combined.additive;
  chain.output(color);
  chain.output(stats);
  for (const ImageId image : additive) chain.output(image);
  chain.plan();
}

Finish::Finish(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit) {
  const int margin = combine_margin_px(task.settings);
  constexpr int grid = 8;
  const TileRules rules{
      .grid = grid, .core_grid = grid, .left = margin, .above = margin, .after = margin, .reach = 0};
  std::string reason;
  tiles_ = plan_tiles(task.full, rules, [&](const Tile& tile) {
    try {
      chain_ = std::make_unique<FinishChain>(device, task, tile.target.extent());
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

void Finish::run(const FinishInputs& inputs, Estimate& result, FrameReport& report) {
  for (const Tile& tile : tiles_) {
    run_tile(tile, inputs, result);
    add_times(report, chain_->chain);
  }
}

void Finish::run_tile(const Tile& tile, const FinishInputs& inputs, Estimate& result) {
  gpu::Chain& chain = chain_->chain;
  chain.upload<float>(chain_->exposure)[0] = inputs.frame.exposure;
  upload(chain, chain_->forward_color, view(inputs.forward.color), tile.target);
  upload(chain, chain_->forward_stats, view(inputs.forward.stats), tile.target);
  upload(chain, chain_->prediction_color, view(inputs.prediction.color), tile.target);
  upload(chain, chain_->prediction_stats, view(inputs.prediction.stats), tile.target);
  upload_additive(chain, chain_->forward_additive, inputs.forward.additive, tile.target);
  upload_additive(chain, chain_->prediction_additive, inputs.prediction.additive, tile.target);
  chain.run();
  copy_core(chain.download<float>(chain_->color), tile, result.color);
  copy_core(chain.download<float>(chain_->stats), tile, result.stats);
  copy_core(download_additive(chain, chain_->additive), tile, result.additive);
}

FilterMemory Finish::memory() const {
  return {.tiles = tiles_.size(),
          .tile = tiles_.front().target.extent(),
          .device_bytes = chain_->chain.device_bytes(),
          .device_bytes_unaliased = chain_->chain.device_bytes_unaliased(),
          .staging_bytes = chain_->chain.staging_bytes()};
}

}  // namespace becalm::filter
