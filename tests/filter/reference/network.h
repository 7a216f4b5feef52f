#pragma once

#include "filter/network/weights.h"
#include "tests/filter/reference/smooth.h"

namespace becalm::reference {

/// The smoothing network in double, as scripts/train/network.py has it. Samples have a count of 1, or 0 for
/// pixels that are not finite; a result's variance is the squared error that the network expects. Without
/// `variance_known` the samples' variances count nothing.
Grid<Estimate> smooth_by_network(const Grid<Estimate>& sample, const Grid<SmoothFeatures>& features,
                                 double exposure, const filter::NetworkWeights& weights, bool variance_known);

}  // namespace becalm::reference
