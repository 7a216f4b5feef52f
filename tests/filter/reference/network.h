#pragma once

#include <array>

#include "filter/smooth/weights.h"
#include "tests/filter/reference/merge.h"

namespace becalm::reference {

/// What a pixel's surroundings are explained by: albedo, depth in [0,2], normal.
using SmoothFeatures = std::array<double, 7>;

/// Features as they were merged, and those of the frame itself.
struct TwoFeatures {
  const Grid<SmoothFeatures>& merged;
  const Grid<SmoothFeatures>& own;
};

/// A frame that was merged, and the frame itself, of which the colour counts.
struct TwoSamples {
  const Grid<Estimate>& merged;
  const Grid<Estimate>& own;
};

/// The smoothing network in double, as scripts/train/network.py has it. Samples have a count of 1, or 0 for
/// pixels that are not finite; a result's variance is the squared error that the network expects. Without
/// `variance_known` the samples' variances count nothing.
Grid<Estimate> smooth_by_network(const TwoSamples& samples, const TwoFeatures& features, double exposure,
                                 const filter::NetworkWeights& weights, bool variance_known);

}  // namespace becalm::reference
