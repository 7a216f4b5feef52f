#include "filter/combine.h"

#include "filter/merge.h"
#include "shaders/shared/merge_params.h"

namespace becalm::filter {

using gpu::Format;
using gpu::ImageId;

Combined add_combine_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent extent,
                            const CombineInputs& inputs) {
  const params::ImageParams size{.width = extent.width, .height = extent.height};
  const ImageId statistics = chain.image("combine.statistics", Format::f32x4, extent);
  chain.pass("merge/combine_statistics")
      .read("forward_color", inputs.forward_color)
      .read("forward_stats", inputs.forward_stats)
      .read("backward_color", inputs.backward_color)
      .read("backward_stats", inputs.backward_stats)
      .read("exposure", inputs.exposure)
      .write("statistics", statistics)
      .constants(size)
      .dispatch(extent);
  const ImageId sums = add_patch_sums(chain, settings, extent, statistics, "combine");
  const Combined combined{chain.image("combined.color", Format::f32x4, extent),
                          chain.image("combined.stats", Format::f32x2, extent)};
  chain.pass("merge/combine")
      .read("forward_color", inputs.forward_color)
      .read("forward_stats", inputs.forward_stats)
      .read("backward_color", inputs.backward_color)
      .read("backward_stats", inputs.backward_stats)
      .read("statistics", statistics)
      .read("statistics_sums", sums)
      .write("color", combined.color)
      .write("stats", combined.stats)
      .specialize("radius", settings.patch_radius)
      .constants(size)
      .dispatch(extent);
  return combined;
}

int combine_margin_px(const Settings& settings) {
  return settings.patch_radius;
}

}  // namespace becalm::filter
