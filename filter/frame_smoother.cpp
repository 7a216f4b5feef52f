#include "filter/frame_smoother.h"

#include <vector>

#include "filter/additive.h"
#include "filter/energy.h"
#include "filter/estimate_variance.h"
#include "filter/host_images.h"
#include "filter/noisy_inputs.h"
#include "filter/smooth.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::ImageId;

struct FrameSmoother::Passes {
  Passes(gpu::Device& device, const FilterTask& task, Extent extent)
      : chain(device, "smooth"),
        noisy(chain, task, extent, NoisyUse::smooth),
        additive(additive_inputs(chain, task, extent, "additive.cur")) {
    const Smoothed smoothed = add_smooth_passes(chain, task.settings, extent, noisy, additive);
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
  ImageId color;
  ImageId stats;
  std::vector<ImageId> smoothed_additive;
};

FrameSmoother::FrameSmoother(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit)
    : task_(task),
      chain_(device, task, local_tile_rules(smooth_margin_px(task.settings) + kVarianceEstimateMargin),
             memory_limit) {}

FrameSmoother::~FrameSmoother() = default;

Estimate FrameSmoother::smooth(const NewFrame& frame, FrameReport& report) {
  Estimate result(task_.full, task_.additive);
  FrameReport ignored;  // what is replaced is counted where the frame is merged
  const auto upload = [&](Passes& passes, const Tile& tile) {
    gpu::Chain& chain = passes.chain;
    passes.noisy.upload(chain, task_, frame, tile, ignored);
    upload_additive(chain, passes.additive, frame.additive, tile.target);
  };
  const auto download = [&](const Passes& passes, const Tile& tile) {
    copy_core(passes.chain.download<float>(passes.color), tile, result.color);
    copy_core(passes.chain.download<float>(passes.stats), tile, result.stats);
    copy_core(download_additive(passes.chain, passes.smoothed_additive), tile, result.additive);
  };
  chain_.run(report, upload, download);
  if (task_.settings.correct_levels > 0) restore_energy(frame, task_, result, task_.settings.smooth_radius);
  return result;
}

FilterMemory FrameSmoother::memory() const {
  return chain_.memory();
}

}  // namespace becalm::filter
