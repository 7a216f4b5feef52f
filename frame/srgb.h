#pragma once

#include <algorithm>
#include <cmath>

namespace becalm {

/// The value that a display takes for linear light, which is clamped to [0, 1] (IEC 61966-2-1).
inline double srgb_encoded(double linear) {
  const double v = std::clamp(linear, 0.0, 1.0);
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
}

}  // namespace becalm
