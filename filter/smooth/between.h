#pragma once

#include <algorithm>

namespace becalm::filter {

/// std::lerp without its branches.
inline double mix(double a, double b, double share) {
  return a + share * (b - a);
}

/// The two of `count` blocks whose centres enclose a position, along one axis. The position is in blocks,
/// relative to the centre of the first block; beyond the outer centres both are nearest blocks.
struct Between {
  Between(double position, int count) {
    const double inside = std::clamp(position, 0.0, count - 1.0);
    low = static_cast<int>(inside);
    high = std::min(low + 1, count - 1);
    share = inside - low;
  }
  int low;
  int high;
  double share;  ///< weight of `high`
};

}  // namespace becalm::filter
