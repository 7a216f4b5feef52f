#include "tracer/procedural/height_pyramid.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cassert>

namespace becalm::tracer {

void HeightPyramid::resize(int resolution, int first_level) {
  assert(std::has_single_bit(static_cast<unsigned>(resolution)) && (resolution >> first_level) >= 1);
  resolution_ = resolution;
  first_level_ = first_level;
  last_level_ = std::countr_zero(static_cast<unsigned>(resolution));
  starts_.clear();
  std::size_t count = 0;
  for (int level = first_level; level <= last_level_; ++level) {
    starts_.push_back(count);
    count += static_cast<std::size_t>(resolution >> level) * static_cast<std::size_t>(resolution >> level);
  }
  ranges_.resize(count);
}

void HeightPyramid::reduce() {
  for (int level = first_level_ + 1; level <= last_level_; ++level) {
    const int n = resolution(level);
    tbb::parallel_for(tbb::blocked_range<int>(0, n, 64), [&](const tbb::blocked_range<int>& rows) {
      for (int j = rows.begin(); j != rows.end(); ++j) {
        for (int i = 0; i < n; ++i) {
          const HeightRange a = at(level - 1, 2 * i, 2 * j), b = at(level - 1, 2 * i + 1, 2 * j);
          const HeightRange c = at(level - 1, 2 * i, 2 * j + 1), d = at(level - 1, 2 * i + 1, 2 * j + 1);
          at(level, i, j) = {std::min({a.low, b.low, c.low, d.low}),
                             std::max({a.high, b.high, c.high, d.high})};
        }
      }
    });
  }
}

}  // namespace becalm::tracer
