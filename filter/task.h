#pragma once

#include <cstddef>

#include "filter/align/guides.h"
#include "filter/gpu/image.h"
#include "filter/settings.h"
#include "frame/aov.h"

namespace becalm::filter {

/// What chains are built for.
struct FilterTask {
  Settings settings;
  gpu::Extent full;
  AovSet used;         ///< what is read of a frame besides the beauty
  AovSet diagnostics;  ///< those that are wanted
  Guides guides;
  std::size_t additive = 0;  ///< how many additive AOVs frames have (merge/additive.h)
  bool merged = false;       ///< frames are merged ones: they have NewFrame::own

  bool has_halves() const { return contains(used, Aov::half_a) && contains(used, Aov::half_b); }
  bool variance_known() const { return contains(used, Aov::variance) || has_halves(); }
  /// In variance mode alone: history that is never rejected would go on multiplying by noisy albedo.
  bool demodulates_history() const {
    return contains(used, Aov::albedo) && settings.merge == MergeMode::variance;
  }
  bool smooths() const { return settings.smooth != Smooth::none; }
  /// Whether smoothed frames only decide the weights by which noisy ones are merged, and what comes out is
  /// smoothed.
  bool smooths_merged() const { return settings.smooth == Smooth::merged; }
  /// Images that are merged with the beauty's weights: additive AOVs, then what is smoothed once it is
  /// merged.
  std::size_t carried() const { return additive + (smooths_merged() ? kNoisyLayers : 0); }

  /// Noisy radiance with its variance; albedo with depth; normal.
  static constexpr std::size_t kNoisyLayers = 3;
};

}  // namespace becalm::filter
