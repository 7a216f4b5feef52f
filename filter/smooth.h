#pragma once

#include <vector>

#include "filter/gpu/chain.h"
#include "filter/noisy_inputs.h"
#include "filter/settings.h"

namespace becalm::filter {

struct Smoothed {
  gpu::ImageId color;                  ///< f32x4
  gpu::ImageId stats;                  ///< f32x2: (variance left, 1; or 0 for a pixel that is not finite)
  std::vector<gpu::ImageId> additive;  ///< f32x4
};

/// Replaces each pixel by what the window around it says of it: a first-order regression on the features,
/// weighted by how alike patches are beyond their noise, and surfaces. `frame` is of NoisyUse::smooth.
/// Additive AOVs (f32x4) are smoothed by the same kernels.
Smoothed add_smooth_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent full,
                           const NoisyInputs& frame, const std::vector<gpu::ImageId>& additive = {});

/// How far from a pixel that reads, in pixels.
int smooth_margin_px(const Settings& settings);

}  // namespace becalm::filter
