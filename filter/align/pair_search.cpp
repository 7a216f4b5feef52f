#include "filter/align/pair_search.h"

#include <string>

#include "filter/align/align.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::Format;

PairSearch::PairSearch(gpu::Device& device, const FilterTask& task, const PyramidSplit& split,
                       Extent target_extent, Extent source_extent)
    : chain(device, "align pair"),
      exposure(chain.table("exposure", Format::f32, {1, 1})),
      target_origin(chain.table("target_origin", Format::f32x2, {1, 1})) {
  const auto features = [&](const std::string& name, Extent extent, FrameInputs& inputs) {
    inputs.color = chain.input("color." + name, Format::f32x4, extent);
    inputs.guide = guide_input(chain, task, "guide." + name, extent);
    return add_frame_features(chain, task, extent, name, inputs, exposure);
  };
  const Features target_features = features("target", target_extent, target);
  const Features source_features = features("source", source_extent, source);
  if (split.has_coarse()) {
    start =
        chain.input("offset.start", Format::f32x2, level_extent(task.settings, target_extent, split.coarse));
  }
  const Alignment found = add_alignment(chain, task.settings,
                                        {.levels = {.finest = 0, .end = split.coarse},
                                         .full = target_extent,
                                         .window = {source_extent, target_origin},
                                         .target = target_features,
                                         .source = source_features,
                                         .start = start,
                                         .start_limit_px = start_limit_px(task, split),
                                         .motion = {}});
  offset = found.offset;
  residual = found.residual;
  chain.output(offset);
  chain.output(residual, level_px(task.settings, 0));
}

}  // namespace becalm::filter
