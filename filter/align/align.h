#pragma once

#include <optional>
#include <string>

#include "filter/align/match_features.h"
#include "filter/align/pyramid.h"
#include "filter/gpu/chain.h"
#include "filter/settings.h"

namespace becalm::filter {

/// The part of the frame that the source images cover; it contains the target's.
struct SourceWindow {
  gpu::Extent full;  ///< size of the source images at full resolution
  /// f32x2, 1x1: position of the target's first pixel in the source images, in full-resolution pixels.
  gpu::ImageId target_origin;
};

/// A window that covers the same part as the target: its origin is zero.
SourceWindow add_same_window(gpu::Chain& chain, gpu::Extent full, const std::string& name);

/// A search over a range of levels, from coarse to fine.
struct Search {
  LevelRange levels;
  gpu::Extent full;  ///< size of the target's images at full resolution
  SourceWindow window;
  Features target;  ///< at level `finest`, as is the source
  Features source;
  /// Start offsets at level `end`; without them the search starts from zero.
  std::optional<gpu::ImageId> start;
  int start_limit_px = 0;  ///< their largest component, in full-resolution pixels
  /// f32x2, full resolution: a candidate start offset at level `motion_level`.
  std::optional<gpu::ImageId> motion;
  int motion_limit_px = 0;  ///< its largest component
};

struct SearchResult {
  gpu::ImageId offset;    ///< f32x2, at level `finest`, in pixels of that level
  gpu::ImageId residual;  ///< of that level, as in Alignment
  int limit_px = 0;       ///< as offset_limit_px
};
SearchResult add_search_passes(gpu::Chain& chain, const Settings& settings, const Search& search);

/// Upsamples offsets of level 0 to full resolution, in full-resolution pixels.
gpu::ImageId add_upsample_pass(gpu::Chain& chain, const Settings& settings, gpu::Extent full,
                               gpu::ImageId offset);

/// Replaces full-resolution offsets by `motion` in pixels that have motion.
gpu::ImageId add_override_pass(gpu::Chain& chain, gpu::Extent full, gpu::ImageId offset, gpu::ImageId motion);

struct Alignment {
  /// f32x2, full resolution: source(p + offset) looks like target(p), in full-resolution pixels.
  gpu::ImageId offset;
  /// f32, at level 0: the patch distance at the offset, the mean over the patch, minus the distance of equal
  /// pixels.
  gpu::ImageId residual;
  int limit_px = 0;  ///< largest component of the offsets
};

/// Searches down to level 0 and upsamples the offsets to full resolution. `settings.motion` selects whether
/// `search.motion` is a candidate of the search or replaces its offsets.
Alignment add_alignment(gpu::Chain& chain, const Settings& settings, const Search& search);

/// Aligns the source's features with the target's by hierarchical patch matching (Hanika et al. 2021,
/// section 3.1), at all levels. `motion`: f32x2, full resolution, from pack_motion; `settings.motion` selects
/// its use.
Alignment add_align_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent full,
                           const Features& target, const Features& source,
                           std::optional<gpu::ImageId> motion = std::nullopt);

}  // namespace becalm::filter
