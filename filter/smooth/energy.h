#pragma once

#include <limits>

#include "filter/estimate.h"
#include "filter/task.h"

namespace becalm::filter {

/// Brings the means of the estimate's colour over large blocks, from the whole frame down to 32 px, to those
/// of the noisy frame, by the share of the difference that its noise does not explain; down to 128 px where a
/// network smooths. The corrections on the device (correct.h) end at smaller blocks, where a bias of a
/// percent drowns in noise; summed over a frame it is what a user sees as a darker shot. The mean of the
/// whole frame comes once more at last, by a percent at most: noise of less than that is not waited for, nor
/// noise that the frame tells and does not have beside the estimate. Additive AOVs take the same factors, and
/// a channel whose mean over the frame is not positive is left. `task` says where the noise is known from;
/// where from nothing, what a pixel has beside the estimate stands for it. An estimate that was made of this
/// frame alone has its very noise, moved by at most `reach_px`: the difference of a block then has only the
/// noise that crossed the block's border. Works on the host, for the whole frame, whatever its tiles.
void restore_energy(const NewFrame& frame, const FilterTask& task, Estimate& estimate,
                    double reach_px = std::numeric_limits<double>::infinity());

}  // namespace becalm::filter
