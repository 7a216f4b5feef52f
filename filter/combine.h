#pragma once

#include <vector>

#include "filter/gpu/chain.h"
#include "filter/settings.h"

namespace becalm::filter {

/// Two estimates of a frame: colours are f32x4, statistics f32x2 of (variance, effective sample count; a
/// count of 0 where nothing is known).
struct CombineInputs {
  gpu::ImageId exposure;       ///< f32, 1x1
  gpu::ImageId forward_color;  ///< from the frames before and the frame itself
  gpu::ImageId forward_stats;
  gpu::ImageId backward_color;  ///< from the frames after it alone
  gpu::ImageId backward_stats;
  std::vector<gpu::ImageId> forward_additive = {};  ///< additive AOVs, f32x4
  std::vector<gpu::ImageId> backward_additive = {};
};

struct Combined {
  gpu::ImageId color;
  gpu::ImageId stats;
  std::vector<gpu::ImageId> additive = {};
};

/// The fixed-interval smoother: both estimates of a frame, weighed by the inverse of their variances.
Combined add_combine_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent extent,
                            const CombineInputs& inputs);

/// How far from a pixel its inputs matter.
int combine_margin_px(const Settings& settings);

}  // namespace becalm::filter
