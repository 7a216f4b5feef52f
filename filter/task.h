#pragma once

#include <cstddef>

#include "filter/align/guides.h"
#include "filter/gpu/image.h"
#include "filter/settings.h"
#include "frame/aov.h"

namespace becalm::filter {

/// What the passes of the chains depend on: settings, frame size and AOVs.
struct FilterTask {
  Settings settings;
  gpu::Extent full;
  AovSet used;         ///< AOVs that are read besides the beauty
  AovSet diagnostics;  ///< diagnostic AOVs requested in the output
  Guides guides;
  std::size_t additive = 0;     ///< number of additive AOVs of a frame (merge/additive.h)
  bool denoises_alpha = false;  ///< where it is noisy
  bool merged = false;          ///< the input frames are merged frames, with NewFrame::own set
  bool of_albedo = false;       ///< the input frames' radiance is an albedo, with noise of another kind

  bool has_halves() const { return contains(used, Aov::half_a) && contains(used, Aov::half_b); }
  bool variance_known() const { return contains(used, Aov::variance) || has_halves(); }
  bool smooths() const { return settings.smooth != Smooth::none; }
  /// Whether smoothed frames only determine the merge weights, and the merged noisy layers are smoothed for
  /// the output.
  bool smooths_merged() const { return settings.smooth == Smooth::merged; }
  /// Whether the variance that smoothing a frame estimates is that of the merge.
  bool hands_noise_on() const { return smooths_merged() && !variance_known() && !of_albedo; }
  bool smooths_albedo() const { return smooths() && settings.smooth_albedo && contains(used, Aov::albedo); }
  bool smooths_alpha() const { return smooths() && denoises_alpha; }
  /// Number of images merged with the beauty's weights: additive AOVs, then the noisy layers that are
  /// smoothed after the merge.
  std::size_t carried() const { return additive + (smooths_merged() ? kNoisyLayers : 0); }

  /// The noisy layers, in the order in which estimates carry them: radiance with its variance; albedo with
  /// depth; normal.
  static constexpr std::size_t kNoisyRadiance = 0;
  static constexpr std::size_t kNoisyAlbedoDepth = 1;
  static constexpr std::size_t kNoisyNormal = 2;
  static constexpr std::size_t kNoisyLayers = 3;
};

}  // namespace becalm::filter
