#pragma once

#include <array>

#include "filter/smooth/weights.h"
#include "tests/filter/reference/merge.h"

namespace becalm::reference {

/// A pixel's features: albedo, depth in [0,2], normal.
using SmoothFeatures = std::array<double, 7>;

/// The merged features, and those of the unmerged frame.
struct TwoFeatures {
  const Grid<SmoothFeatures>& merged;
  const Grid<SmoothFeatures>& own;
};

/// A merged frame, and the unmerged one, of which only the colour is used.
struct TwoSamples {
  const Grid<Estimate>& merged;
  const Grid<Estimate>& own;
};

/// Of a merged frame: the unmerged one smoothed alone, its expected squared error as variance, and the layers
/// that tell the shares.
struct Alone {
  const Grid<Estimate>& smoothed;
  const filter::ShareWeights& shares;
};

/// The smoothing network in double, as in scripts/train/network.py. Samples have a count of 1, or 0 for
/// non-finite pixels. A result's variance is the squared error that the network expects. Without
/// `variance_known` the samples' variances are ignored. With `alone` the result is mixed with the unmerged
/// frame and with that.
Grid<Estimate> smooth_by_network(const TwoSamples& samples, const TwoFeatures& features, double exposure,
                                 const filter::NetworkWeights& weights, bool variance_known,
                                 const Alone* alone);

}  // namespace becalm::reference
