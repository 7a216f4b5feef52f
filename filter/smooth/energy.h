#pragma once

#include "filter/estimate.h"
#include "filter/task.h"

namespace becalm::filter {

/// Restores light that smoothing removed with bright samples. Scales the estimate's colour in blocks, from
/// the whole frame down to 16 px: each block's mean moves towards the noisy frame's by the share of the
/// squared difference that exceeds 4 times the variance of the frame's noise. Where the difference has d
/// standard deviations, one level changes a block's factor by at most d / 48, and at most doubles or halves
/// it. Bright pixels get most of the light (Restorable). Pixels around which the frame is within 1 % of the
/// estimate, such as a clean sky, are scaled by little or nothing, and none are brightened by more than the
/// bright samples that may have been removed around them. Then scales the whole frame once more, by 1 % at
/// most, since blocks with a bright sample are noisier than others and are corrected by a smaller share.
/// `task` says which AOVs the frame's variance comes from; where it is unknown, the squared difference from
/// the estimate, minus that of the block's means, is used. Additive AOVs are scaled by the same factors,
/// which moves the mean of one with outliers by 1 to 3 %. A channel whose mean over the frame is not positive
/// is unchanged. Runs on the host, since blocks are larger than tiles.
void restore_energy(const NewFrame& frame, const FilterTask& task, Estimate& estimate);

}  // namespace becalm::filter
