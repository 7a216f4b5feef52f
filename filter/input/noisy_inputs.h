#pragma once

#include <optional>

#include "filter/estimate.h"
#include "filter/gpu/chain.h"
#include "filter/input/surface_images.h"
#include "filter/report.h"
#include "filter/task.h"
#include "filter/tiles/tiles.h"

namespace becalm::filter {

/// The chain that reads a noisy frame; the smoothing chain always reads features.
enum class NoisyUse { smooth, merge };

/// A noisy frame, or a tile of it, as the input of a chain. A chain that merges smoothed frames alone takes
/// nothing but the exposure and counts the replaced variances. One that merges noisy layers takes the
/// variance that smoothing the frame has estimated (Estimate::noise).
class NoisyInputs {
 public:
  /// Declares the inputs and, for frames that come without variance, the pass that estimates it.
  NoisyInputs(gpu::Chain& chain, const FilterTask& task, gpu::Extent extent, NoisyUse use);
  /// Uploads the target rectangle of a tile and counts the replaced variances.
  void upload(gpu::Chain& chain, const FilterTask& task, const NewFrame& frame, const Tile& tile,
              FrameReport& report) const;

  bool has_albedo;                        ///< if false, the albedo is 1 everywhere
  bool has_depth;                         ///< if false, the depth is 0 everywhere
  bool has_normal;                        ///< if false, the normal is 0 everywhere
  gpu::ImageId color;                     ///< f32x4, non-finite pixels replaced
  gpu::ImageId own_color;                 ///< of a merged frame: the unmerged frame's, else the same
  gpu::ImageId variance;                  ///< f32x2, as MergeInputs::variance
  gpu::ImageId exposure;                  ///< f32, 1x1
  std::optional<SurfaceImages> features;  ///< if a pass reads them
  /// Of a merged frame: the unmerged frame's features, else the same.
  std::optional<SurfaceImages> own_features;

 private:
  gpu::ImageId given_variance_;
  std::optional<gpu::ImageId> noise_ratio_;  ///< if the variance is estimated
  bool takes_noise_ = false;                 ///< the variance is Estimate::noise
};

}  // namespace becalm::filter
