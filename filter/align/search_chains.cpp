#include "filter/align/search_chains.h"

#include "filter/ceil_div.h"

namespace becalm::filter {
namespace {

using gpu::Extent;
using gpu::Format;

/// Limit of the motion that is a candidate in the coarse chain; 0 if none is.
int coarse_motion_limit_px(const FilterTask& task, const PyramidSplit& split) {
  return coarse_takes_motion(task, split) ? largest_motion_px(task.settings, task.full) : 0;
}

}  // namespace

FeatureChain::FeatureChain(gpu::Device& device, const FilterTask& task, const PyramidSplit& split, Of of,
                           Extent part, Outputs outputs)
    : chain(device, of == Of::history ? "features of the history" : "features of the frame") {
  const Settings& settings = task.settings;
  const std::string name = of == Of::history ? "source" : "target";
  const int planes = task.guides.planes();
  color = chain.input("color", Format::f32x4, part);
  exposure = chain.table("exposure", Format::f32, {1, 1});
  FeatureSources sources{.color = color, .exposure = exposure, .guide_features = {}, .guide_planes = planes};
  if (planes > 0) {
    const Extent matching = level_extent(settings, part, 0).with_planes(planes);
    if (of == Of::history) {
      guide = sources.guide_features = chain.input("guide.features", Format::f32, matching);
    } else {
      guide = chain.input("guide", Format::f32, part.with_planes(planes));
      sources.guide_features = chain.image("guide.features", Format::f32, matching);
      add_guide_passes(chain, settings, part, *guide, task.guides.weights, *sources.guide_features);
    }
  }
  finest = add_feature_passes(chain, settings, part, name, sources);
  if (outputs == Outputs::finest_and_coarse) chain.output(finest.image, level_px(settings, 0));
  if (split.has_coarse()) {
    coarse = add_pyramid(chain, settings, {.finest = 0, .end = split.coarse + 1}, part, finest, name).back();
    chain.output(coarse->image, level_px(settings, split.coarse));
  }
}

CoarseChain::CoarseChain(gpu::Device& device, const FilterTask& task, const PyramidSplit& split)
    : chain(device, "coarse levels") {
  const Extent extent = level_extent(task.settings, task.full, split.coarse);
  const int planes = task.guides.planes() + 1;
  target = feature_input(chain, "features.target", extent, planes);
  source = feature_input(chain, "features.source", extent, planes);
  if (coarse_takes_motion(task, split)) motion = chain.input("motion", Format::f32x2, task.full);
  const SearchResult found = add_search_passes(chain, task.settings,
                                               {.name = {},
                                                .levels = {.finest = split.coarse, .end = split.levels},
                                                .full = task.full,
                                                .window = add_same_window(chain, task.full, "origin"),
                                                .target = target,
                                                .source = source,
                                                .start = {},
                                                .motion = motion,
                                                .motion_limit_px = coarse_motion_limit_px(task, split)});
  offset = found.offset;
  chain.output(offset, level_px(task.settings, split.coarse));
}

Features feature_input(gpu::Chain& chain, const std::string& name, Extent extent, int planes) {
  return {chain.input(name, Format::f32, extent.with_planes(planes)), planes};
}

bool coarse_takes_motion(const FilterTask& task, const PyramidSplit& split) {
  return contains(task.used, Aov::motion) && task.settings.motion == MotionUse::guide &&
         motion_level(split.levels) >= split.coarse;
}

int start_limit_px(const FilterTask& task, const PyramidSplit& split) {
  return offset_limit_px(task.settings, {split.coarse, split.levels}, 0, coarse_motion_limit_px(task, split));
}

Rect at_level(const Rect& rect, int px) {
  return {rect.x / px, rect.y / px, ceil_div(rect.width, px), ceil_div(rect.height, px)};
}

}  // namespace becalm::filter
