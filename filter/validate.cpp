#include "filter/validate.h"

#include <algorithm>

#include "shaders/shared/merge_params.h"

namespace becalm::filter {

using gpu::Chain;
using gpu::Extent;
using gpu::Format;
using gpu::ImageId;

unsigned applicable_rules(const Settings& settings, const AovSet& available) {
  unsigned rules = validate_flow;
  if (contains(available, Aov::depth)) rules |= validate_depth;
  if (contains(available, Aov::normal)) rules |= validate_normal;
  if (contains(available, Aov::object_id)) rules |= validate_id;
  return settings.validate & rules;
}

int validate_margin_px(const Settings& settings) {
  const int slope = settings.validate & validate_depth ? 1 : 0;
  return std::max(slope, settings.history_clip == HistoryClip::none ? 0 : settings.clip_radius);
}

ImageId add_validate_pass(Chain& chain, const Settings& settings, Extent full, unsigned rules,
                          const FramePair& surface, const Alignment& alignment, const SourceWindow& window) {
  const bool by_surface = (rules & kValidateBySurface) != 0;
  const ImageId trust = chain.image("trust", Format::f32x2, full);
  chain.pass("merge/validate")
      .read("offset", alignment.offset)
      .read("surface", by_surface ? surface.current : alignment.offset)
      .read("history_surface", by_surface ? surface.previous : alignment.offset)
      .read("target_origin", window.target_origin)
      .read("consistency", alignment.consistency.value_or(alignment.offset))
      .write("trust", trust)
      .specialize("by_depth", rules & validate_depth ? 1 : 0)
      .specialize("by_normal", rules & validate_normal ? 1 : 0)
      .specialize("by_id", rules & validate_id ? 1 : 0)
      .specialize("by_flow", rules & validate_flow ? 1 : 0)
      .constants(params::ValidateParams{.width = full.width,
                                        .height = full.height,
                                        .history_width = window.full.width,
                                        .history_height = window.full.height,
                                        .depth_tolerance = settings.depth_tolerance,
                                        .normal_tolerance = settings.normal_tolerance})
      .dispatch(full);
  return trust;
}

WarpedHistory add_rectify_pass(Chain& chain, const Settings& settings, Extent full, ImageId color,
                               ImageId variance, const WarpedHistory& warped) {
  const WarpedHistory rectified{chain.image("rectified.color", Format::f32x4, full),
                                chain.image("rectified.stats", Format::f32x2, full)};
  chain.pass("merge/rectify")
      .read("color", color)
      .read("variance", variance)
      .read("warped_color", warped.color)
      .read("warped_stats", warped.stats)
      .write("rectified_color", rectified.color)
      .write("rectified_stats", rectified.stats)
      .specialize("kind", static_cast<int>(settings.history_clip))
      .specialize("ycocg", settings.clip_space == ClipSpace::ycocg ? 1 : 0)
      .specialize("radius", settings.clip_radius)
      .constants(
          params::RectifyParams{.width = full.width, .height = full.height, .gamma = settings.clip_gamma})
      .dispatch(full);
  return rectified;
}

}  // namespace becalm::filter
