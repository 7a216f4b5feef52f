#include "filter/merge/combine.h"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "filter/merge/estimate_inputs.h"
#include "filter/merge/patch_sums.h"
#include "filter/tiles/pixel_view.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

Combined add_combine_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent extent,
                            const CombineInputs& inputs) {
  const ImageId statistics = chain.image("combine.statistics", Format::f32x4, extent);
  chain.pass("merge/combine_statistics")
      .read("forward_color", inputs.forward_color)
      .read("forward_stats", inputs.forward_stats)
      .read("backward_color", inputs.backward_color)
      .read("backward_stats", inputs.backward_stats)
      .read("exposure", inputs.exposure)
      .write("statistics", statistics)
      .dispatch(extent);
  const PatchSums sums = add_patch_sums(chain, settings.patch_radius, extent, statistics, "combine");
  const bool has_carried = !inputs.forward_carried.empty();
  Combined combined{chain.image("combined.color", Format::f32x4, extent),
                    chain.image("combined.stats", Format::f32x2, extent)};
  std::optional<ImageId> weight;
  if (has_carried) weight = chain.image("combine.weight", Format::f32, extent);
  chain.pass("merge/combine")
      .read("forward_color", inputs.forward_color)
      .read("forward_stats", inputs.forward_stats)
      .read("backward_color", inputs.backward_color)
      .read("backward_stats", inputs.backward_stats)
      .read("statistics", statistics, sums.reach)
      .read("statistics_sums", sums.sums)
      .write("color", combined.color)
      .write("stats", combined.stats)
      .write("weight_backward", weight)
      .specialize("radius", settings.patch_radius)
      .specialize("smoothed", settings.smooth == Smooth::none ? 0 : 1)
      .specialize("writes_weight", has_carried ? 1 : 0)
      .dispatch(extent);
  for (std::size_t i = 0; i < inputs.forward_carried.size(); ++i) {
    combined.carried.push_back(chain.image(fmt::format("combined.carried.{}", i), Format::f32x4, extent));
    chain.pass("merge/carried_combine")
        .read("forward_color", inputs.forward_carried[i])
        .read("backward_color", inputs.backward_carried[i])
        .read("weight", weight)
        .write("combined", combined.carried.back())
        .dispatch(extent);
  }
  return combined;
}

struct Combiner::Passes {
  Passes(gpu::Device& device, const FilterTask& task, Extent extent)
      : chain(device, "combine"),
        exposure(chain.table("exposure", Format::f32, {1, 1})),
        forward(chain, task, extent, "forward"),
        prediction(chain, task, extent, "prediction"),
        combined(add_combine_passes(chain, task.settings, extent,
                                    {.exposure = exposure,
                                     .forward_color = forward.color,
                                     .forward_stats = forward.stats,
                                     .backward_color = prediction.color,
                                     .backward_stats = prediction.stats,
                                     .forward_carried = forward.carried,
                                     .backward_carried = prediction.carried})) {
    chain.output(combined.color);
    chain.output(combined.stats);
    for (const ImageId image : combined.carried) chain.output(image);
  }

  gpu::Chain chain;
  ImageId exposure;
  EstimateInputs forward;
  EstimateInputs prediction;
  Combined combined;
};

Combiner::Combiner(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit)
    : task_(task), chain_(device, task, memory_limit) {}

Combiner::~Combiner() = default;

Estimate Combiner::run(float exposure, Estimate forward, Estimate prediction, FrameReport& report) {
  Estimate result = chain_.is_whole() ? Estimate() : Estimate(task_.full, task_.carried());
  const auto upload = [&](Passes& passes, const Tile& tile) {
    passes.chain.upload<float>(passes.exposure)[0] = exposure;
    passes.forward.upload(passes.chain, forward, tile.target);
    passes.prediction.upload(passes.chain, prediction, tile.target);
    if (!chain_.is_whole()) return;
    result = std::exchange(forward, {});  // its memory alone is needed from here on
    prediction = {};
  };
  const auto download = [&](const Passes& passes, const Tile& tile) {
    copy_core(passes.chain.download<float>(passes.combined.color), tile, result.color);
    copy_core(passes.chain.download<float>(passes.combined.stats), tile, result.stats);
    copy_core(download_carried(passes.chain, passes.combined.carried), tile, result.carried);
  };
  chain_.run(report, upload, download);
  return result;
}

FilterMemory Combiner::memory() const {
  return chain_.memory();
}

}  // namespace becalm::filter
