#include "filter/smooth/frame_smoother.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "filter/input/host_images.h"
#include "filter/input/noisy_inputs.h"
#include "filter/merge/carried_images.h"
#include "filter/smooth/network.h"
#include "filter/tiles/pixel_view.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::ImageId;

namespace {

std::vector<Layered> layered(const std::vector<ImageId>& merged, const std::vector<ImageId>& own) {
  std::vector<Layered> result;
  for (std::size_t i = 0; i < merged.size(); ++i) result.push_back({merged[i], own[i]});
  return result;
}

Weights weights_of(const FilterTask& task) {
  if (task.of_albedo) return {embedded_albedo_weights(), nullptr};
  return {embedded_weights(), &embedded_own_share()};
}

/// Ratios of noise (input/noise_ratio.h) up to which the network for independent noise smooths, and from
/// which the one for noise that neighbours share does. Of 54 noisy frames of independent noise, and of 54
/// of hardly any, which may be all detail, the largest ratio is 1.5. Samples weighed by a Gaussian of 0.35
/// pixels have 1.2 to 1.5, by a tent of a pixel 2.6 to 3.
constexpr float kIndependent = 1.5f;
constexpr float kShared = 2.0f;
/// From one to the other, so that frames of a sequence seldom need others than the frame before.
constexpr float kSteps = 4.0f;

float share_of_shared_noise(float noise_ratio) {
  const float share = std::clamp((noise_ratio - kIndependent) / (kShared - kIndependent), 0.0f, 1.0f);
  return std::round(share * kSteps) / kSteps;
}

}  // namespace

struct FrameSmoother::Passes {
  Passes(gpu::Device& device, const FilterTask& task, Extent extent)
      : chain(device, "smooth"),
        noisy(chain, task, extent, NoisyUse::smooth),
        additive(carried_inputs(chain, task.additive, extent, "additive.cur")),
        own_additive(task.merged ? carried_inputs(chain, task.additive, extent, "additive.own") : additive),
        network(chain, weights_of(task), extent, noisy, task.variance_known(),
                layered(additive, own_additive), convolver_of(device.info())) {
    chain.output(network.smoothed().color);
    chain.output(network.smoothed().stats);
    for (const ImageId image : network.smoothed().additive) chain.output(image);
    if (task.hands_noise_on()) chain.output(noisy.variance);
  }

  gpu::Chain chain;
  NoisyInputs noisy;
  std::vector<ImageId> additive;
  std::vector<ImageId> own_additive;  ///< of merged frames: those of the unmerged frame, else the same
  NetworkPasses network;
};

FrameSmoother::FrameSmoother(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit)
    : task_(task), chain_(device, task, memory_limit) {
  Passes& passes = chain_.passes();
  passes.network.upload_weights(passes.chain, weights_of(task).network);
}

FrameSmoother::~FrameSmoother() = default;

void FrameSmoother::choose_network(float noise_ratio) {
  const float share = share_of_shared_noise(noise_ratio);
  if (share == shared_noise_) return;
  Passes& passes = chain_.passes();
  passes.network.upload_weights(passes.chain,
                                between(embedded_weights(), embedded_shared_noise_weights(), share));
  shared_noise_ = share;
}

Estimate FrameSmoother::smooth(const NewFrame& frame, FrameReport& report) {
  if (!task_.of_albedo) choose_network(frame.noise_ratio);
  Estimate result(task_.full, task_.additive);
  if (task_.hands_noise_on()) result.noise = Image(task_.full.width, task_.full.height, 2, Unfilled());
  FrameReport ignored;  // replaced variances are counted when the frame is merged
  const auto upload = [&](Passes& passes, const Tile& tile) {
    gpu::Chain& chain = passes.chain;
    passes.noisy.upload(chain, task_, frame, tile, ignored);
    upload_carried(chain, passes.additive, frame.additive, tile.target);
    if (task_.merged) upload_carried(chain, passes.own_additive, frame.own->additive, tile.target);
  };
  const auto download = [&](const Passes& passes, const Tile& tile) {
    const Smoothed& smoothed = passes.network.smoothed();
    copy_core(passes.chain.download<float>(smoothed.color), tile, result.color);
    copy_core(passes.chain.download<float>(smoothed.stats), tile, result.stats);
    copy_core(download_carried(passes.chain, smoothed.additive), tile, result.carried);
    if (!result.noise.empty())
      copy_core(passes.chain.download<float>(passes.noisy.variance), tile, result.noise);
  };
  chain_.run(report, upload, download);
  return result;
}

FilterMemory FrameSmoother::memory() const {
  return chain_.memory();
}

}  // namespace becalm::filter
