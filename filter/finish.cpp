#include "filter/finish.h"

#include <string>
#include <vector>

#include "filter/additive.h"
#include "filter/combine.h"
#include "filter/pixel_view.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

namespace {

/// An estimate, or a tile of it, as the input of a chain.
struct EstimateInputs {
  EstimateInputs(gpu::Chain& chain, const FilterTask& task, Extent extent, const std::string& name)
      : color(chain.input(name + ".color", Format::f32x4, extent)),
        stats(chain.input(name + ".stats", Format::f32x2, extent)),
        additive(additive_inputs(chain, task.carried(), extent, name + ".additive")) {}

  void upload(gpu::Chain& chain, const Estimate& estimate, const Rect& rect) const {
    filter::upload(chain, color, view(estimate.color), rect);
    filter::upload(chain, stats, view(estimate.stats), rect);
    upload_additive(chain, additive, estimate.additive, rect);
  }

  ImageId color;
  ImageId stats;
  std::vector<ImageId> additive;
};

}  // namespace

struct Finish::Passes {
  Passes(gpu::Device& device, const FilterTask& task, Extent extent)
      : chain(device, "finish"),
        exposure(chain.input("exposure", Format::f32, {1, 1})),
        forward(chain, task, extent, "forward"),
        prediction(chain, task, extent, "prediction"),
        combined(add_combine_passes(chain, task.settings, extent,
                                    {.exposure = exposure,
                                     .forward_color = forward.color,
                                     .forward_stats = forward.stats,
                                     .backward_color = prediction.color,
                                     .backward_stats = prediction.stats,
                                     .forward_additive = forward.additive,
                                     .backward_additive = prediction.additive})) {
    chain.output(combined.color);
    chain.output(combined.stats);
    for (const ImageId image : combined.additive) chain.output(image);
    chain.plan();
  }

  gpu::Chain chain;
  ImageId exposure;
  EstimateInputs forward;
  EstimateInputs prediction;
  Combined combined;
};

Finish::Finish(gpu::Device& device, const FilterTask& task, std::uint64_t memory_limit)
    : chain_(device, task, local_tile_rules(combine_margin_px(task.settings)), memory_limit) {}

Finish::~Finish() = default;

void Finish::run(const FinishInputs& inputs, Estimate& result, FrameReport& report) {
  const auto upload = [&](Passes& passes, const Tile& tile) {
    passes.chain.upload<float>(passes.exposure)[0] = inputs.frame.exposure;
    passes.forward.upload(passes.chain, inputs.forward, tile.target);
    passes.prediction.upload(passes.chain, inputs.prediction, tile.target);
  };
  const auto download = [&](const Passes& passes, const Tile& tile) {
    copy_core(passes.chain.download<float>(passes.combined.color), tile, result.color);
    copy_core(passes.chain.download<float>(passes.combined.stats), tile, result.stats);
    copy_core(download_additive(passes.chain, passes.combined.additive), tile, result.additive);
  };
  chain_.run(report, upload, download);
}

FilterMemory Finish::memory() const {
  return chain_.memory();
}

}  // namespace becalm::filter
