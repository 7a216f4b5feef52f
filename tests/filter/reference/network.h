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

/// The smoothing network in double, as in scripts/train/network.py. Samples have a count of 1, or 0 for
/// non-finite pixels. A result's variance is the squared error that the network expects. Without
/// `variance_known` the samples' variances are ignored.
Grid<Estimate> windows_of_network(const TwoSamples& samples, const TwoFeatures& features, double exposure,
                                  const filter::NetworkWeights& weights, bool variance_known);

/// The same with what is put back of the frame. With `own_share` the result is mixed with the unmerged frame.
Grid<Estimate> smooth_by_network(const TwoSamples& samples, const TwoFeatures& features, double exposure,
                                 const filter::NetworkWeights& weights, bool variance_known,
                                 const filter::OwnShareWeights* own_share);

}  // namespace becalm::reference
