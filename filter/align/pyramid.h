#pragma once

#include <cstddef>
#include <vector>

#include "filter/gpu/image.h"
#include "filter/settings.h"

namespace becalm::filter {

/// Every level of the pyramid searches the shifts [-kWindowReach, kWindowReach]^2.
constexpr int kWindowReach = 2;

/// Sizes of the matching pyramid, the finest level first. Level 0 is the frame over `match_downsample`; each
/// further level is `pyramid.factor` smaller, rounded up. If `pyramid.levels` is 0, there are enough levels
/// to reach 9 % of the longer side (170 px at 1920x1080, as in Hanika et al. 2021, section 3.1). No level but
/// the first is smaller than 8 px.
std::vector<gpu::Extent> pyramid_extents(const Settings& settings, int width, int height);

/// Largest motion in full-resolution pixels that the pyramid can find: the sum over levels of the window's
/// reach.
int reach_px(const Settings& settings, std::size_t levels);

/// Levels `finest` to `end` - 1 of a pyramid.
struct LevelRange {
  std::size_t finest = 0;
  std::size_t end = 0;
};

/// Largest component of the offsets that a search over these levels returns, in full-resolution pixels. It
/// starts from offsets of at most `start_px`; known motion of at most `motion_px` is a candidate.
int offset_limit_px(const Settings& settings, const LevelRange& levels, int start_px = 0, int motion_px = 0);

/// Longest component of motion that shaders/lib/motion.glsl takes as known.
constexpr float kLongestMotion = 999'999.0f;

/// Limit of the components of known motion, in full-resolution pixels; longer motion is ignored. For a
/// candidate of the search: 256 px, or an eighth of the frame's longer side if that is more, with and without
/// tiles, since tiles would need the whole history otherwise. For the offset itself: kLongestMotion.
float motion_limit_px(const Settings& settings, gpu::Extent full);

/// Largest component of known motion that counts: longer motion leads out of the frame or is ignored.
int largest_motion_px(const Settings& settings, gpu::Extent full);

/// Size at pyramid level `level` of images that have the size `full` at full resolution, rounded up at every
/// level.
gpu::Extent level_extent(const Settings& settings, gpu::Extent full, std::size_t level);

/// Side of a level's pixel, in full-resolution pixels.
int level_px(const Settings& settings, std::size_t level);

/// The level, of `levels` in all, at which known motion is a candidate.
std::size_t motion_level(std::size_t levels);

}  // namespace becalm::filter
