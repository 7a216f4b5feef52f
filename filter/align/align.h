#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filter/align/match_features.h"
#include "filter/align/pyramid.h"
#include "filter/gpu/chain.h"
#include "filter/settings.h"
#include "filter/tiles/tiles.h"

namespace becalm::filter {

/// Source images that show more of the frame than the target's.
struct SourceWindow {
  gpu::Extent full;  ///< their size at full resolution
  gpu::ImageId
      target_origin;  ///< f32x2, 1x1: where the target's first pixel lies in them, in full-resolution px
};

/// A window of which the target's images are all: the origin is zero.
SourceWindow add_same_window(gpu::Chain& chain, gpu::Extent full, const std::string& name);

/// The search of a range of levels, from coarse to fine.
struct Search {
  std::string name;  ///< begins the names of its images
  LevelRange levels;
  gpu::Extent full;  ///< the target's images at full resolution
  SourceWindow window;
  Features target;  ///< of level `finest`, as is the source
  Features source;
  std::optional<gpu::ImageId>
      start;  ///< offsets of level `end`, to start from; else the search starts from zero
  std::optional<gpu::ImageId>
      motion;  ///< f32x2, full resolution: a candidate where level `motion_level` starts from
};

struct SearchResult {
  gpu::ImageId offset;                 ///< f32x2, of level `finest` and in its pixels
  std::vector<gpu::ImageId> residual;  ///< from level `finest` on, as in Alignment
};
SearchResult add_search_passes(gpu::Chain& chain, const Settings& settings, const Search& search);

/// What tiles must keep that search levels below `end` by themselves, from offsets of level `end` that are
/// the whole frame's, if full-resolution offsets are wanted `margin_px` around their cores. Their offsets
/// then are bit for bit those of the whole frame.
TileRules search_tile_rules(const Settings& settings, const gpu::DeviceInfo& device, std::size_t levels,
                            std::size_t end, int margin_px);

/// Offsets of level 0 at full resolution, in full-resolution pixels.
gpu::ImageId add_upsample_pass(gpu::Chain& chain, const Settings& settings, gpu::Extent full,
                               gpu::ImageId offset, const std::string& name = "");

/// Offsets at full resolution that are `motion` wherever that is known.
gpu::ImageId add_override_pass(gpu::Chain& chain, gpu::Extent full, gpu::ImageId offset, gpu::ImageId motion,
                               const std::string& name = "");

struct Alignment {
  gpu::ImageId
      offset;  ///< f32x2, full resolution: source(p + offset) looks like target(p), in full-resolution px
  /// Patch distance at the offset for each pyramid level (f32, sizes of pyramid_extents): the mean over the
  /// patch, less the distance of equal pixels.
  std::vector<gpu::ImageId> residual;
};

struct AlignOptions {
  std::string name;  ///< begins the names of the images, where a chain aligns more than once
  /// f32x2, full resolution: motion as pack_motion gives it, used as `settings.motion` says.
  std::optional<gpu::ImageId> motion;
};

/// Aligns the source's features with the target's by hierarchical patch matching (Hanika et al. 2021,
/// section 3.1).
Alignment add_align_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent full,
                           const Features& target, const Features& source, const AlignOptions& options = {});

}  // namespace becalm::filter
