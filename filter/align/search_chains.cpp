#include "filter/align/search_chains.h"

#include "filter/ceil_div.h"
#include "filter/tiles/pixel_view.h"

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
  color = chain.input("color", Format::f32x4, part);
  exposure = chain.table("exposure", Format::f32, {1, 1});
  const int planes = task.guides.planes();
  if (of == Of::history) {
    if (planes > 0) {
      guide = chain.input("guide.features", Format::f32, level_extent(settings, part, 0).with_planes(planes));
    }
    finest = add_feature_passes(
        chain, settings, part, name,
        {.color = color, .exposure = exposure, .guide_features = guide, .guide_planes = planes});
  } else {
    guide = guide_input(chain, task, "guide", part);
    finest = add_frame_features(chain, task, part, name, {.color = color, .guide = guide}, exposure);
  }
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
                                               {.levels = {.finest = split.coarse, .end = split.levels},
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

std::optional<gpu::ImageId> guide_input(gpu::Chain& chain, const FilterTask& task, const std::string& name,
                                        Extent part) {
  if (task.guides.planes() == 0) return std::nullopt;
  return chain.input(name, Format::f32, part.with_planes(task.guides.planes()));
}

Features add_frame_features(gpu::Chain& chain, const FilterTask& task, Extent part, const std::string& name,
                            const FrameInputs& inputs, gpu::ImageId exposure,
                            std::optional<gpu::ImageId> guide_features) {
  const int planes = task.guides.planes();
  if (inputs.guide) {
    if (!guide_features) {
      guide_features = chain.image("guide.features." + name, Format::f32,
                                   level_extent(task.settings, part, 0).with_planes(planes));
    }
    add_guide_passes(chain, task.settings, part, *inputs.guide, task.guides.weights, *guide_features);
  }
  return add_feature_passes(chain, task.settings, part, name,
                            {.color = inputs.color,
                             .exposure = exposure,
                             .guide_features = guide_features,
                             .guide_planes = planes});
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

Image download_offset(const CoarseChain& coarse, const FilterTask& task, const PyramidSplit& split) {
  return download(coarse.chain, coarse.offset, level_extent(task.settings, task.full, split.coarse), 2);
}

void upload_start(gpu::Chain& chain, gpu::ImageId start, const Image& coarse_offset, const FilterTask& task,
                  const PyramidSplit& split, const Rect& target) {
  upload(chain, start, view(coarse_offset), at_level(target, level_px(task.settings, split.coarse)));
}

Rect at_level(const Rect& rect, int px) {
  return {rect.x / px, rect.y / px, ceil_div(rect.width, px), ceil_div(rect.height, px)};
}

}  // namespace becalm::filter
