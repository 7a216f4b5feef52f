#pragma once

#include "filter/estimate.h"
#include "filter/task.h"

namespace becalm::filter {

/// Gives the light back that smoothing took out with bright samples: brings the means of the estimate's
/// colour over blocks, from the whole frame down to 128 px, to those of the noisy frame, by the share of the
/// difference that the frame's noise does not explain. Then the mean of the whole frame once more, by a
/// percent at most, since blocks with a bright sample are noisier than others and take less of their
/// difference. `task` says where the frame's variance is known from; a pixel without it has its squared
/// difference from the estimate. Additive AOVs take the same factors. A channel whose mean over the frame is
/// not positive stays as it is.
///
/// On the host, since blocks are larger than tiles.
void restore_energy(const NewFrame& frame, const FilterTask& task, Estimate& estimate);

}  // namespace becalm::filter
