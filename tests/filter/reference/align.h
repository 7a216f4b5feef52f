#pragma once

#include "filter/settings.h"
#include "tests/filter/reference/grid.h"

namespace becalm::reference {

struct Alignment {
  Grid<Vec2> offset;      ///< at matching resolution, in its pixels
  Grid<double> residual;  ///< of the finest level
  /// True where rounding may decide: at this level or at the coarser pixels of its start offset, the two
  /// lowest costs differ by less than a relative 1e-4.
  Grid<char> ambiguous;
};

/// The aligner of Hanika et al. 2021, section 3.1, in plain form: no bands, no sliding sums, all in double.
/// The features are planes at matching resolution; `levels` counts pyramid levels.
Alignment align(const std::vector<Grid<double>>& target, const std::vector<Grid<double>>& source,
                const filter::Settings& settings, std::size_t levels);

}  // namespace becalm::reference
