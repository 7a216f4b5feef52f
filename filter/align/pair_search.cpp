#include "filter/align/pair_search.h"

#include "filter/align/align.h"

namespace becalm::filter {

using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

PairSearch::PairSearch(gpu::Device& device, const FilterTask& task, const PyramidSplit& split,
                       Extent target_extent, Extent source_extent)
    : chain(device, "align pair"),
      exposure(chain.table("exposure", Format::f32, {1, 1})),
      target_origin(chain.table("target_origin", Format::f32x2, {1, 1})) {
  const Settings& settings = task.settings;
  const Features target_features = add_features(task, target_extent, "target", target);
  const Features source_features = add_features(task, source_extent, "source", source);
  if (contains(task.used, Aov::motion) && settings.motion != MotionUse::none &&
      !coarse_takes_motion(task, split)) {
    motion = chain.input("motion", Format::f32x2, target_extent);
  }
  if (split.has_coarse()) {
    start = chain.input("offset.start", Format::f32x2, level_extent(settings, target_extent, split.coarse));
  }
  const bool guides = motion && settings.motion == MotionUse::guide;
  const SearchResult found = add_search_passes(chain, settings,
                                               {.name = {},
                                                .levels = {.finest = 0, .end = split.coarse},
                                                .full = target_extent,
                                                .window = {source_extent, target_origin},
                                                .target = target_features,
                                                .source = source_features,
                                                .start = start,
                                                .start_limit_px = start_limit_px(task, split),
                                                .motion = guides ? motion : std::nullopt,
                                                .motion_limit_px = largest_motion_px(settings, task.full)});
  offset = add_upsample_pass(chain, settings, target_extent, found.offset);
  if (motion && settings.motion == MotionUse::override_offset) {
    offset = add_override_pass(chain, target_extent, offset, *motion);
  }
  residual = found.residual;
  chain.output(offset);
  chain.output(residual, level_px(settings, 0));
}

Features PairSearch::add_features(const FilterTask& task, Extent extent, const std::string& name,
                                  Inputs& inputs) {
  inputs.color = chain.input("color." + name, Format::f32x4, extent);
  const int planes = task.guides.planes();
  FeatureSources sources{
      .color = inputs.color, .exposure = exposure, .guide_features = {}, .guide_planes = planes};
  if (planes > 0) {
    inputs.guide = chain.input("guide." + name, Format::f32, extent.with_planes(planes));
    sources.guide_features = chain.image("guide.features." + name, Format::f32,
                                         level_extent(task.settings, extent, 0).with_planes(planes));
    add_guide_passes(chain, task.settings, extent, *inputs.guide, task.guides.weights,
                     *sources.guide_features);
  }
  return add_feature_passes(chain, task.settings, extent, name, sources);
}

}  // namespace becalm::filter
