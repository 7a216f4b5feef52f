#include "filter/merge/merge_chains.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "filter/merge/carried_images.h"

namespace becalm::filter {
using gpu::Extent;
using gpu::Format;

gpu::History MergeChain::history(const std::string& name, Format format, bool is_whole_frame, Extent target,
                                 Extent source) {
  if (is_whole_frame) return chain.history(name, format, target);
  return {.previous = chain.input(name + ".prev", format, source),
          .next = chain.image(name + ".next", format, target)};
}

MergeChain::Matched MergeChain::features_of_frame(const FilterTask& task, gpu::ImageId target_color) {
  const int planes = task.guides.planes();
  std::optional<gpu::ImageId> features;
  std::optional<gpu::ImageId> previous_features;
  guide = guide_input(chain, task, "guide.cur", task.full);
  if (guide) {
    const gpu::History kept = chain.history("guide.features", Format::f32,
                                            level_extent(task.settings, task.full, 0).with_planes(planes));
    features = kept.next;
    previous_features = kept.previous;
  }
  return {.target = add_frame_features(chain, task, task.full, "target",
                                       {.color = target_color, .guide = guide}, noisy.exposure, features),
          .source = add_feature_passes(chain, task.settings, task.full, "source",
                                       {.color = color.previous,
                                        .exposure = noisy.exposure,
                                        .guide_features = previous_features,
                                        .guide_planes = planes}),
          .window = add_same_window(chain, task.full, "origin")};
}

MergeChain::Matched MergeChain::features_of_tile(const FilterTask& task, const PyramidSplit& split,
                                                 Extent target, Extent source) {
  const int planes = task.guides.planes() + 1;
  cut = Cut{
      .target_origin = chain.table("target_origin", Format::f32x2, {1, 1}),
      .target = feature_input(chain, "features.target.L0", level_extent(task.settings, target, 0), planes),
      .source = feature_input(chain, "features.source.L0", level_extent(task.settings, source, 0), planes),
      .start = {}};
  if (split.has_coarse()) {
    cut->start =
        chain.input("offset.start", Format::f32x2, level_extent(task.settings, target, split.coarse));
  }
  return {.target = cut->target, .source = cut->source, .window = {source, cut->target_origin}};
}

MergeChain::MergeChain(gpu::Device& device, const FilterTask& task, const PyramidSplit& split, Extent target,
                       Extent source, bool is_whole_frame)
    : chain(device, "merge"), noisy(chain, task, target, NoisyUse::merge) {
  const Settings& settings = task.settings;
  gpu::ImageId new_color = noisy.color;
  gpu::ImageId new_variance = noisy.variance;
  if (task.smooths()) {
    smoothed_color = new_color = chain.input("smoothed.color", Format::f32x4, target);
    smoothed_stats = new_variance = chain.input("smoothed.stats", Format::f32x2, target);
  }
  color = history("history.color", Format::f32x4, is_whole_frame, target, source);
  stats = history("history.stats", Format::f32x2, is_whole_frame, target, source);
  if (contains(task.used, Aov::motion) && !coarse_takes_motion(task, split)) {
    motion = chain.input("motion.cur", Format::f32x2, target);
  }
  const Matched matched =
      is_whole_frame ? features_of_frame(task, new_color) : features_of_tile(task, split, target, source);
  const Alignment found = add_alignment(chain, settings,
                                        {.levels = {.finest = 0, .end = split.coarse},
                                         .full = target,
                                         .window = matched.window,
                                         .target = matched.target,
                                         .source = matched.source,
                                         .start = cut ? cut->start : std::nullopt,
                                         .start_limit_px = start_limit_px(task, split),
                                         .motion = motion,
                                         .motion_limit_px = largest_motion_px(settings, task.full)});
  offset_ = found.offset;
  residual_ = found.residual;

  additive = carried_inputs(chain, task.additive, target, "additive.cur");
  for (std::size_t i = 0; i < task.carried(); ++i) {
    carried.push_back(
        history(fmt::format("history.carried.{}", i), Format::f32x4, is_whole_frame, target, source));
  }
  std::vector<CarriedInput> inputs;
  for (std::size_t i = 0; i < additive.size(); ++i) inputs.push_back({additive[i], carried[i]});
  if (task.smooths_merged()) {
    const std::span<const gpu::History> layers = std::span(carried).subspan(additive.size());
    for (const CarriedInput& layer : add_noisy_layers(chain, target, noisy, layers)) inputs.push_back(layer);
  }
  outputs_ = add_merge_passes(chain, settings, target,
                              {.noisy = noisy,
                               .color = new_color,
                               .variance = new_variance,
                               .history_color = color,
                               .history_stats = stats,
                               .history_window = matched.window,
                               .carried = inputs},
                              found);
  add_outputs(task);
}

void MergeChain::add_outputs(const FilterTask& task) {
  predicts_ = task.settings.directions == Directions::both;
  wants_offset_ = contains(task.diagnostics, Aov::flow);
  wants_residual_ = contains(task.diagnostics, Aov::residual);
  chain.output(color.next);
  chain.output(stats.next);
  for (const gpu::History& image : carried) chain.output(image.next);
  chain.output(outputs_.decision);
  if (predicts_) {
    chain.output(outputs_.warped_color);
    chain.output(outputs_.warped_stats);
    for (const gpu::ImageId image : outputs_.warped_carried) chain.output(image);
  }
  if (wants_offset_) chain.output(offset_);
  if (wants_residual_) chain.output(residual_, level_px(task.settings, 0));
}

MergedTile MergeChain::download() const {
  MergedTile tile;
  tile.color = chain.download<float>(color.next);
  tile.stats = chain.download<float>(stats.next);
  for (const gpu::History& image : carried) tile.carried.push_back(chain.download<float>(image.next));
  tile.decision = chain.download<float>(outputs_.decision);
  if (predicts_) {
    tile.warped_color = chain.download<float>(outputs_.warped_color);
    tile.warped_stats = chain.download<float>(outputs_.warped_stats);
    tile.warped_carried = download_carried(chain, outputs_.warped_carried);
  }
  if (wants_offset_) tile.offset = chain.download<float>(offset_);
  if (wants_residual_) tile.residual = chain.download<float>(residual_);
  return tile;
}

}  // namespace becalm::filter
