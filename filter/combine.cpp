#include "filter/combine.h"

#include <fmt/format.h>

#include "filter/merge.h"
#include "filter/patch_sums.h"
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
  const ImageId sums = add_patch_sums(chain, settings.patch_radius, extent, statistics, "combine");
  const bool has_additive = !inputs.forward_additive.empty();
  Combined combined{chain.image("combined.color", Format::f32x4, extent),
                    chain.image("combined.stats", Format::f32x2, extent)};
  const ImageId weight =
      chain.image("combine.weight", Format::f32, has_additive ? extent : gpu::Extent{1, 1});
  chain.pass("merge/combine")
      .read("forward_color", inputs.forward_color)
      .read("forward_stats", inputs.forward_stats)
      .read("backward_color", inputs.backward_color)
      .read("backward_stats", inputs.backward_stats)
      .read("statistics", statistics)
      .read("statistics_sums", sums)
      .write("color", combined.color)
      .write("stats", combined.stats)
      .write("weight_backward", weight)
      .specialize("radius", settings.patch_radius)
      .specialize("smoothed", settings.smooth == Smooth::none ? 0 : 1)
      .specialize("writes_weight", has_additive ? 1 : 0)
      .constants(size)
      .dispatch(extent);
  for (std::size_t i = 0; i < inputs.forward_additive.size(); ++i) {
    combined.additive.push_back(chain.image(fmt::format("combined.additive.{}", i), Format::f32x4, extent));
    chain.pass("additive/combine")
        .read("forward_color", inputs.forward_additive[i])
        .read("backward_color", inputs.backward_additive[i])
        .read("weight", weight)
        .write("combined", combined.additive.back())
        .constants(size)
        .dispatch(extent);
  }
  return combined;
}

int combine_margin_px(const Settings& settings) {
  return settings.patch_radius;
}

}  // namespace becalm::filter
