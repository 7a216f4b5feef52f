#include "filter/align/pyramid.h"

#include <algorithm>

#include "filter/ceil_div.h"

namespace becalm::filter {
namespace {

using gpu::Extent;

/// Known motion is a candidate at the second finest level: the finest alone cannot correct an error of
/// several pixels, and coarser levels blur the edges of the motion.
constexpr std::size_t kMotionLevel = 1;
constexpr int kSmallestLevel = 8;  // px; in a smaller level a patch covers the whole image
constexpr double kReachOfLongerSide = 0.09;
constexpr int kSmallestGuideLimit = 256;  // px
constexpr int kGuideLimitShare = 8;       // the limit is the longer side divided by this

Extent shrink(Extent extent, int factor) {
  return {ceil_div(extent.width, factor), ceil_div(extent.height, factor)};
}

int guide_limit_px(Extent full) {
  return std::max(kSmallestGuideLimit, std::max(full.width, full.height) / kGuideLimitShare);
}

}  // namespace

std::vector<Extent> pyramid_extents(const Settings& settings, int width, int height) {
  std::vector<Extent> extents{shrink({width, height}, settings.match_downsample)};
  const double wanted_reach = kReachOfLongerSide * std::max(width, height);
  while (settings.pyramid.levels > 0 ? extents.size() < static_cast<std::size_t>(settings.pyramid.levels)
                                     : reach_px(settings, extents.size()) < wanted_reach) {
    const Extent next = shrink(extents.back(), settings.pyramid.factor);
    if (std::min(next.width, next.height) < kSmallestLevel) break;
    extents.push_back(next);
  }
  return extents;
}

int reach_px(const Settings& settings, std::size_t levels) {
  return offset_limit_px(settings, {.finest = 0, .end = levels});
}

int offset_limit_px(const Settings& settings, const LevelRange& levels, int start_px, int motion_px) {
  int limit = start_px;
  for (std::size_t l = levels.end; l-- > levels.finest;) {
    if (l == motion_level(levels.end)) limit = std::max(limit, motion_px);
    limit += kWindowReach * level_px(settings, l);
  }
  return limit;
}

std::size_t motion_level(std::size_t levels) {
  return std::min(kMotionLevel, levels - 1);
}

float motion_limit_px(const Settings& settings, Extent full) {
  if (settings.motion == MotionUse::override_offset) return kLongestMotion;
  return static_cast<float>(guide_limit_px(full));
}

int largest_motion_px(const Settings& settings, Extent full) {
  if (settings.motion == MotionUse::override_offset) return std::max(full.width, full.height);
  return guide_limit_px(full);
}

Extent level_extent(const Settings& settings, Extent full, std::size_t level) {
  Extent extent = shrink(full, settings.match_downsample);
  for (std::size_t l = 0; l < level; ++l) extent = shrink(extent, settings.pyramid.factor);
  return extent;
}

int level_px(const Settings& settings, std::size_t level) {
  int px = settings.match_downsample;
  for (std::size_t l = 0; l < level; ++l) px *= settings.pyramid.factor;
  return px;
}

}  // namespace becalm::filter
