#include "filter/frame_smoother.h"

#include <optional>
#include <vector>

#include "filter/additive.h"
#include "filter/energy.h"
#include "filter/estimate_variance.h"
#include "filter/host_images.h"
#include "filter/network/network.h"
#include "filter/noisy_inputs.h"
#include "filter/smooth.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::ImageId;

struct FrameSmoother::Passes {
  Passes(gpu::Device& device, const FilterTask& task, Extent extent)
      : chain(device, "smooth"),
        noisy(chain, task, extent, NoisyUse::smooth),
        additive(additive_inputs(chain, task.additive, extent, "additive.cur")) {
    Smoothed smoothed;
    if (task.settings.smooth == Smooth::regression) {
      smoothed = add_smooth_passes(chain, task.settings, extent, noisy, additive);
    } else {
      network.emplace(chain, embedded_weights(), extent, noisy, task.variance_known(), additive);
      smoothed = network->smoothed();
    }
    color = smoothed.color;
    smoothed_additive = smoothed.additive;
    stats = smoothed.stats;
    chain.output(color);
    chain.output(stats);
    for (const ImageId image : smoothed_additive) chain.output(image);
    chain.plan();
  }

  gpu::Chain chain;
  NoisyInputs noisy;
  std::vector<ImageId> additive;
  std::optional<NetworkPasses> network;
  ImageId color;
  ImageId stats;
  std::vector<ImageId> smoothed_additive;
};

namespace {

TileRules tile_rules(const Settings& settings) {
  if (settings.smooth == Smooth::regression) {
    return local_tile_rules(smooth_margin_px(settings) + kVarianceEstimateMargin);
  }
  return local_tile_rules(network_margin_px() + kVarianceEstimateMargin, kNetworkGridPx);
}

/// How far from where it was noise is found after smoothing, for the energy of blocks.
double reach_px(const Settings& settings) {
  constexpr double of_network = 16.0;
  return settings.smooth == Smooth::regression ? settings.smooth_radius : of_network;
}

}  // namespace

FrameSmoother::FrameSmoother(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit)
    : task_(task), chain_(device, task, tile_rules(task.settings), memory_limit) {}

FrameSmoother::~FrameSmoother() = default;

Estimate FrameSmoother::smooth(const NewFrame& frame, FrameReport& report) {
  Estimate result(task_.full, task_.additive);
  FrameReport ignored;  // what is replaced is counted where the frame is merged
  const auto upload = [&](Passes& passes, const Tile& tile) {
    gpu::Chain& chain = passes.chain;
    passes.noisy.upload(chain, task_, frame, tile, ignored);
    if (passes.network) passes.network->upload_weights(chain);
    upload_additive(chain, passes.additive, frame.additive, tile.target);
  };
  const auto download = [&](const Passes& passes, const Tile& tile) {
    copy_core(passes.chain.download<float>(passes.color), tile, result.color);
    copy_core(passes.chain.download<float>(passes.stats), tile, result.stats);
    copy_core(download_additive(passes.chain, passes.smoothed_additive), tile, result.additive);
  };
  chain_.run(report, upload, download);
  if (task_.settings.correct_levels > 0) restore_energy(frame, task_, result, reach_px(task_.settings));
  return result;
}

FilterMemory FrameSmoother::memory() const {
  return chain_.memory();
}

}  // namespace becalm::filter
