#pragma once

#include <array>

#include "tests/filter/reference/merge.h"

namespace becalm::reference {

/// What a pixel's surroundings are explained by: albedo, depth in [0,2], normal.
using SmoothFeatures = std::array<double, 7>;

/// First-order regression on the features, weighted by non-local means with the variance known. Samples have
/// a count of 1, or 0 for pixels that are not finite.
Grid<Estimate> smooth(const Grid<Estimate>& sample, const Grid<SmoothFeatures>& features, double exposure,
                      const filter::Settings& settings);

}  // namespace becalm::reference
