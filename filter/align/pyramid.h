#pragma once

#include <cstddef>
#include <vector>

#include "filter/gpu/image.h"
#include "filter/settings.h"

namespace becalm::filter {

/// At every level of the pyramid the shifts [-kWindowReach, kWindowReach]^2 are searched.
constexpr int kWindowReach = 2;

/// Sizes of the matching pyramid, the finest level first. Level 0 is the frame over `match_downsample`; each
/// further level is `pyramid_factor` smaller, rounded up. With `pyramid_levels` 0 there are as many as it
/// takes to reach 9 % of the longer side (170 px at 1920x1080, as in Hanika et al. 2021, section 3.1), but no
/// level below 8 px.
std::vector<gpu::Extent> pyramid_extents(const Settings& settings, int width, int height);

/// Largest motion in full-resolution pixels that the pyramid can find: the sum over levels of the window's
/// reach.
int reach_px(const Settings& settings, std::size_t levels);

/// Largest component of a known motion that counts as known. As a candidate of the search it is 256 px, or an
/// eighth of the frame's longer side where that is more, for tiles and whole frames alike: a tile that had to
/// follow it anywhere would have to see the whole history. As the offset itself it has no limit.
float motion_limit_px(const Settings& settings, gpu::Extent full);

/// Largest offset in full-resolution pixels that the search may end at where known motion is given.
int reach_of_motion_px(const Settings& settings, gpu::Extent full, std::size_t levels);

/// Size at pyramid level `level` of images that are `full` at full resolution, rounded up at every level.
gpu::Extent level_extent(const Settings& settings, gpu::Extent full, std::size_t level);

/// Full-resolution pixels in one of a level, along each axis.
int level_px(const Settings& settings, std::size_t level);

/// The level of `levels` that starts from known motion.
std::size_t motion_level(std::size_t levels);

/// Levels `finest` to `end` - 1 of a pyramid.
struct LevelRange {
  std::size_t finest = 0;
  std::size_t end = 0;
};

}  // namespace becalm::filter
