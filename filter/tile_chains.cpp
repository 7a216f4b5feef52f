#include "filter/tile_chains.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "filter/additive.h"

namespace becalm::filter {
namespace {

using gpu::Extent;
using gpu::Format;

Features feature_input(gpu::Chain& chain, const std::string& name, Extent extent, int planes) {
  return {chain.input(name, Format::f32, extent.with_planes(planes)), planes};
}

/// Whether the levels from `coarse` on start from known motion, or those below it.
bool coarse_takes_motion(const FilterTask& task, const PyramidSplit& split) {
  return contains(task.used, Aov::motion) && task.settings.motion == MotionUse::guide &&
         motion_level(split.levels) >= split.coarse;
}

}  // namespace

FeatureChain::FeatureChain(gpu::Device& device, const FilterTask& task, const PyramidSplit& split, Of of,
                           Extent part)
    : chain(device, of == Of::history ? "features of the history" : "features of the frame") {
  const Settings& settings = task.settings;
  const std::string name = of == Of::history ? "source" : "target";
  const int planes = task.guides.planes();
  color = chain.input("color", Format::f32x4, part);
  exposure = chain.input("exposure", Format::f32, {1, 1});
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
  chain.output(finest.image);
  if (split.has_coarse()) {
    coarse = add_pyramid(chain, settings, {.finest = 0, .end = split.coarse + 1}, part, finest, name).back();
    chain.output(coarse->image);
  }
  chain.plan();
}

CoarseChain::CoarseChain(gpu::Device& device, const FilterTask& task, const PyramidSplit& split, int planes)
    : chain(device, "coarse levels") {
  const Extent extent = level_extent(task.settings, task.full, split.coarse);
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
                                                .motion = motion});
  offset = found.offset;
  chain.output(offset);
  chain.plan();
}

TileChain::TileChain(gpu::Device& device, const FilterTask& task, const PyramidSplit& split, int planes,
                     Extent target_extent, Extent source_extent)
    : chain(device, "tile"), noisy(chain, task, target_extent, NoisyUse::merge) {
  const Settings& settings = task.settings;
  gpu::ImageId color = noisy.color;
  gpu::ImageId variance = noisy.variance;
  if (task.smooths()) {
    smoothed_color = color = chain.input("smoothed.color", Format::f32x4, target_extent);
    smoothed_stats = variance = chain.input("smoothed.stats", Format::f32x2, target_extent);
  }
  history_color = chain.input("history.color.prev", Format::f32x4, source_extent);
  history_stats = chain.input("history.stats.prev", Format::f32x2, source_extent);
  target_origin = chain.input("target_origin", Format::f32x2, {1, 1});
  target = feature_input(chain, "features.target.L0", level_extent(settings, target_extent, 0), planes);
  source = feature_input(chain, "features.source.L0", level_extent(settings, source_extent, 0), planes);
  if (split.has_coarse()) {
    start = chain.input("offset.start", Format::f32x2, level_extent(settings, target_extent, split.coarse));
  }
  if (contains(task.used, Aov::motion) && !coarse_takes_motion(task, split)) {
    motion = chain.input("motion.cur", Format::f32x2, target_extent);
  }
  const bool guides = motion && settings.motion == MotionUse::guide;
  const SourceWindow window{source_extent, target_origin};
  const SearchResult found = add_search_passes(chain, settings,
                                               {.name = {},
                                                .levels = {.finest = 0, .end = split.coarse},
                                                .full = target_extent,
                                                .window = window,
                                                .target = target,
                                                .source = source,
                                                .start = start,
                                                .motion = guides ? motion : std::nullopt});
  merged.offset = add_upsample_pass(chain, settings, target_extent, found.offset);
  if (motion && settings.motion == MotionUse::override_offset) {
    merged.offset = add_override_pass(chain, target_extent, merged.offset, *motion);
  }
  merged.residual = found.residual.front();

  if (task.demodulates_history()) {
    albedo = {chain.input("albedo.cur", Format::f32x4, target_extent),
              chain.input("albedo.prev", Format::f32x4, source_extent)};
  }
  merged.color = chain.image("history.color.next", Format::f32x4, target_extent);
  merged.stats = chain.image("history.stats.next", Format::f32x2, target_extent);
  additive = additive_inputs(chain, task.additive, target_extent, "additive.cur");
  history_additive = additive_inputs(chain, task.carried(), source_extent, "history.additive.prev");
  std::vector<gpu::History> history;
  for (std::size_t i = 0; i < task.carried(); ++i) {
    const std::string name = fmt::format("history.additive.next.{}", i);
    merged.additive.push_back(chain.image(name, Format::f32x4, target_extent));
    history.push_back({history_additive[i], merged.additive[i]});
  }
  merged.outputs =
      add_merge_passes(chain, settings, target_extent,
                       {.noisy = noisy,
                        .color = color,
                        .variance = variance,
                        .history_color = {history_color, merged.color},
                        .history_stats = {history_stats, merged.stats},
                        .history_window = window,
                        .additive = carried_inputs(chain, task, target_extent, noisy, additive, history),
                        .albedo = albedo},
                       {merged.offset, found.residual});
  add_outputs(chain, task, merged);
  chain.plan();
}

}  // namespace becalm::filter
