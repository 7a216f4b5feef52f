#include "filter/whole_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include "filter/additive.h"
#include "filter/align.h"
#include "filter/host_images.h"
#include "filter/pixel_view.h"

namespace becalm::filter {

using gpu::Format;

namespace {

/// Makes what was new in the last run the last frame's, and returns where the new frame's goes. Before the
/// first run there is no history that it would be of.
std::span<float> upload_next(gpu::Chain& chain, const FramePair& pair) {
  const auto current = chain.upload<float>(pair.current);
  std::ranges::copy(current, chain.upload<float>(pair.previous).begin());
  return current;
}

}  // namespace

WholeFrame::WholeFrame(gpu::Device& device, FilterTask task)
    : task_(std::move(task)), chain_(device, "filter"), noisy_(chain_, task_, task_.full, NoisyUse::merge) {
  const Settings& settings = task_.settings;
  const gpu::Extent full = task_.full;
  gpu::ImageId color = noisy_.color;
  gpu::ImageId variance = noisy_.variance;
  if (task_.smooths()) {
    smoothed_color_ = color = chain_.input("smoothed.color", Format::f32x4, full);
    smoothed_stats_ = variance = chain_.input("smoothed.stats", Format::f32x2, full);
  }
  const gpu::History history_color = chain_.history("history.color", Format::f32x4, full);
  const gpu::History history_stats = chain_.history("history.stats", Format::f32x2, full);

  FeatureSources target{.color = color, .exposure = noisy_.exposure, .guide_features = {}, .guide_planes = 0};
  FeatureSources source{
      .color = history_color.previous, .exposure = noisy_.exposure, .guide_features = {}, .guide_planes = 0};
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
  const Features target_features = add_feature_passes(chain_, settings, full, "target", target);
  const Features source_features = add_feature_passes(chain_, settings, full, "source", source);
  const Alignment alignment = add_align_passes(chain_, settings, full, target_features, source_features,
                                               {.name = {}, .motion = motion_});
  merged_.offset = alignment.offset;
  merged_.residual = alignment.residual.front();
  if (task_.demodulates_history()) {
    albedo_ = {chain_.input("albedo.cur", Format::f32x4, full),
               chain_.input("albedo.prev", Format::f32x4, full)};
  }

  additive_ = additive_inputs(chain_, task_.additive, full, "additive.cur");
  std::vector<gpu::History> history;
  for (std::size_t i = 0; i < task_.carried(); ++i) {
    history.push_back(chain_.history(fmt::format("history.additive.{}", i), Format::f32x4, full));
    merged_.additive.push_back(history.back().next);
  }
  const std::vector<CarriedInput> additive = carried_inputs(chain_, task_, full, noisy_, additive_, history);

  merged_.color = history_color.next;
  merged_.stats = history_stats.next;
  merged_.outputs = add_merge_passes(chain_, settings, full,
                                     {.noisy = noisy_,
                                      .color = color,
                                      .variance = variance,
                                      .history_color = history_color,
                                      .history_stats = history_stats,
                                      .history_window = {},
                                      .additive = additive,
                                      .albedo = albedo_},
                                     alignment);
  add_outputs(chain_, task_, merged_);
  chain_.plan();
}

void WholeFrame::merge(const NewFrame& frame, MergedFrame& merged, FrameReport& report) {
  const Tile all = uncut(task_.full);
  noisy_.upload(chain_, task_, frame, all, report);
  if (task_.smooths()) {
    upload(chain_, smoothed_color_, view(frame.smoothed.color), all.target);
    upload(chain_, smoothed_stats_, view(frame.smoothed.stats), all.target);
  }
  upload_additive(chain_, additive_, frame.merged_additive(), all.target);
  if (guide_) {
    pack_guide(frame.frame, task_.guides.albedo, task_.guides.normal, all.target,
               chain_.upload<float>(*guide_));
  }
  if (motion_) {
    pack_motion(frame.frame.image(Aov::motion), all.target, motion_limit_px(task_.settings, task_.full),
                chain_.upload<float>(*motion_));
  }
  if (albedo_) pack_albedo(frame.frame.image(Aov::albedo), all.target, upload_next(chain_, *albedo_));
  chain_.run();
  add_times(report, chain_);
  unpack(download(chain_, task_, merged_), all, merged);
}

FilterMemory WholeFrame::memory() const {
  FilterMemory memory{.tiles = 1, .tile = task_.full};
  add_memory(memory, chain_);
  return memory;
}

}  // namespace becalm::filter
