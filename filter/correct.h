#pragma once

#include <optional>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/settings.h"

namespace becalm::filter {

/// What an estimate of a frame is corrected by, all at full resolution.
struct CorrectionInputs {
  gpu::ImageId color;                           ///< f32x4: the frame, noisy
  gpu::ImageId variance;                        ///< f32x2, as MergeInputs::variance
  gpu::ImageId exposure;                        ///< f32, 1x1
  std::optional<gpu::ImageId> half_difference;  ///< f32x4: (half_a - half_b) / 2, where a frame has both
  gpu::ImageId estimate;                        ///< f32x4: what is corrected
  gpu::ImageId estimate_stats;  ///< f32x2: (variance, count); a count of 0 means that there is no estimate
  std::vector<gpu::ImageId> additive = {};  ///< f32x4: additive AOVs of the estimate
};

struct Corrected {
  gpu::ImageId estimate;               ///< f32x4, as are the additive AOVs
  std::vector<gpu::ImageId> additive;  ///< by the factors of the estimate
};

/// Brings the means of the estimate over blocks of 2^`correct_levels` to 2 pixels near those of the frame,
/// whose noise averages out of them: what filters lose or gain of the light in places is given back. How much
/// noise that is, half-buffers say; where frames are smoothed half-buffers and variance on average. What
/// is returned is linear in the estimate given the factors.
Corrected add_correction_passes(gpu::Chain& chain, const Settings& settings, gpu::Extent full,
                                const CorrectionInputs& inputs);

/// How far from a pixel a correction reads, in pixels, and what tiles must begin at multiples of.
int correction_margin_px(const Settings& settings);
int correction_grid_px(const Settings& settings);

}  // namespace becalm::filter
