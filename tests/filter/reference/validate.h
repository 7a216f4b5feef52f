#pragma once

#include <array>

#include "filter/settings.h"
#include "tests/filter/reference/grid.h"
#include "tests/filter/reference/merge.h"

namespace becalm::reference {

/// What a pixel shows. Nothing is hit at an infinite depth.
struct Surface {
  double depth = 0.0;
  std::array<double, 3> normal{};
  double id = 0.0;
};

/// Trust in the history where the target's pixels are, by the rules in `settings.validate`.
Grid<double> trust(const Grid<Surface>& now, const Grid<Surface>& before, const Grid<Vec2>& offset,
                   const filter::Settings& settings);

/// The warped history in the box of the sample's colours around each pixel. The sample's count is 1, or 0 for
/// a pixel that is not finite.
Grid<Estimate> rectify(const Grid<Estimate>& sample, const Grid<Estimate>& warped,
                       const filter::Settings& settings);

}  // namespace becalm::reference
