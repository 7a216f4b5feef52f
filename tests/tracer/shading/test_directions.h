#pragma once

#include <cmath>
#include <numbers>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// The direction at these angles from +z and from +x.
inline V3f direction(double theta_deg, double phi_deg) {
  const double theta = theta_deg * std::numbers::pi / 180.0;
  const double phi = phi_deg * std::numbers::pi / 180.0;
  return V3f(V3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)));
}

}  // namespace becalm::tracer
