#pragma once

#include <algorithm>
#include <array>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// The transform, scaled along the axes that it shortens to less than 2^-40 of the longest one or of the
/// unit, to that length: so its inverse stays within 2^40, and its determinant within the range of floats.
/// `transform` scales, then rotates, then translates: its axes are at right angles.
inline M44f thickened(const M44f& transform) {
  std::array<double, 3> length;
  for (int i = 0; i < 3; ++i) length[i] = V3d(transform[i][0], transform[i][1], transform[i][2]).length();
  const double least = 0x1p-40 * std::max(std::ranges::max(length), 1.0);
  M44f result = transform;
  for (int i = 0; i < 3; ++i) {
    if (!(length[i] > 0.0 && length[i] < least)) continue;
    for (int j = 0; j < 3; ++j) result[i][j] = static_cast<float>(transform[i][j] * (least / length[i]));
  }
  return result;
}

}  // namespace becalm::tracer
