#pragma once

#include "tests/filter/reference/merge.h"

namespace becalm::reference {

/// The estimate with its means over blocks brought to those of the frame, level by level from blocks of
/// 2^levels px. A count of 0 means that there is no sample, or no estimate. `half_difference` is empty, or
/// noise of the frame alone; `with_variance` says whether the frame's variance counts besides.
Grid<Rgba> correct(const Grid<Estimate>& frame, const Grid<Estimate>& estimate,
                   const Grid<Rgba>& half_difference, double exposure, int levels, bool with_variance);

}  // namespace becalm::reference
