#include "filter/whole_frame.h"

#include <utility>

#include "filter/align.h"
#include "filter/host_images.h"

namespace becalm::filter {

using gpu::Format;

WholeFrame::WholeFrame(gpu::Device& device, FilterTask task)
    : task_(std::move(task)), chain_(device, "filter") {
  const Settings& settings = task_.settings;
  const gpu::Extent full = task_.full;
  color_ = chain_.input("color.cur", Format::f32x4, full);
  exposure_ = chain_.input("exposure", Format::f32, {1, 1});
  variance_ = chain_.input("variance.cur", Format::f32x2, full);
  const gpu::History history_color = chain_.history("history.color", Format::f32x4, full);
  const gpu::History history_stats = chain_.history("history.stats", Format::f32x2, full);

  FeatureSources target{.color = color_, .exposure = exposure_, .guide_features = {}, .guide_planes = 0};
  FeatureSources source{
      .color = history_color.previous, .exposure = exposure_, .guide_features = {}, .guide_planes = 0};
  if (const int planes = task_.guides.planes(); planes > 0) {
    guide_ = chain_.input("guide.cur", Format::f32, full.with_planes(planes));
    const gpu::History features =
        chain_.history("guide.features", Format::f32, level_extent(settings, full, 0).with_planes(planes));
    add_guide_passes(chain_, settings, full, *guide_, task_.guides.weights, features.next);
    target.guide_features = features.next;
    source.guide_features = features.previous;
    target.guide_planes = source.guide_planes = planes;
  }
  if (contains(task_.used, Aov::motion)) motion_ = chain_.input("motion.cur", Format::f32x2, full);
  if (task_.needs_half_difference()) {
    half_difference_ = chain_.input("half_difference.cur", Format::f32x4, full);
  }
  const Alignment alignment = add_align_passes(
      chain_, settings, full, add_feature_passes(chain_, settings, full, "target", target),
      add_feature_passes(chain_, settings, full, "source", source), {.name = {}, .motion = motion_});
  offset_ = alignment.offset;

  outputs_ = add_merge_passes(
      chain_, settings, full,
      {.color = color_,
       .variance =
           task_.variance_known() ? variance_ : add_variance_estimate(chain_, full, color_, variance_),
       .exposure = exposure_,
       .half_difference = half_difference_,
       .history_color = history_color,
       .history_stats = history_stats},
      alignment);
  merged_color_ = history_color.next;
  merged_stats_ = history_stats.next;
  chain_.output(merged_color_);
  chain_.output(merged_stats_);
  chain_.output(outputs_.decision);
  if (settings.directions == Directions::both) {
    chain_.output(outputs_.warped_color);
    chain_.output(outputs_.warped_stats);
  }
  if (contains(task_.diagnostics, Aov::flow)) chain_.output(offset_);
  chain_.plan();
}

void WholeFrame::merge(const NewFrame& frame, MergedFrame& merged, FrameReport& report) {
  const Tile all = uncut(task_.full);
  pack_color(frame.frame.image(Aov::beauty), frame.finite, all.target, chain_.upload<float>(color_));
  report.replaced_variances +=
      pack_variance(frame.frame, task_.used, frame.finite, all, chain_.upload<float>(variance_));
  chain_.upload<float>(exposure_)[0] = frame.exposure;
  if (guide_) {
    pack_guide(frame.frame, task_.guides.albedo, task_.guides.normal, all.target,
               chain_.upload<float>(*guide_));
  }
  if (motion_) pack_motion(frame.frame.image(Aov::motion), all.target, chain_.upload<float>(*motion_));
  if (half_difference_) {
    pack_half_difference(frame.frame, all.target, chain_.upload<float>(*half_difference_));
  }
  chain_.run();
  add_times(report, chain_);
  MergedTile images{.color = chain_.download<float>(merged_color_),
                    .stats = chain_.download<float>(merged_stats_),
                    .warped_color = {},
                    .warped_stats = {},
                    .decision = chain_.download<float>(outputs_.decision),
                    .offset = {}};
  if (task_.settings.directions == Directions::both) {
    images.warped_color = chain_.download<float>(outputs_.warped_color);
    images.warped_stats = chain_.download<float>(outputs_.warped_stats);
  }
  if (contains(task_.diagnostics, Aov::flow)) images.offset = chain_.download<float>(offset_);
  unpack(images, all, merged);
}

FilterMemory WholeFrame::memory() const {
  return {.tiles = 1,
          .tile = task_.full,
          .device_bytes = chain_.device_bytes(),
          .device_bytes_unaliased = chain_.device_bytes_unaliased(),
          .staging_bytes = chain_.staging_bytes()};
}

}  // namespace becalm::filter
