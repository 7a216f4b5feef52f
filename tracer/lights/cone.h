#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// 1 - cos of an angle, without the cancellation.
inline double versine(double angle_rad) {
  const double s = std::sin(0.5 * angle_rad);
  return 2.0 * s * s;
}

/// Whether an axis that was normalized is one: false for what came from 0 or NaN.
inline bool has_direction(const V3d& axis) {
  return axis.length2() > 0.5;
}

/// The directions within an angle of an axis. Angles are kept as versines (1 - cos), which is what solid
/// angles are linear in and what stays exact for cones of any size.
struct Cone {
  V3d axis;    ///< unit
  double rim;  ///< versine of the angle between axis and rim, in (0, 2]

  double solid_angle() const { return 2.0 * std::numbers::pi * rim; }

  struct Direction {
    V3d dir;  ///< unit
    double cosine;
    double sine_squared;
  };
  /// Uniform by solid angle: u.x from the axis to the rim, u.y around.
  Direction sample(const V2f& u) const {
    const double v = rim * u.x;
    const double sine_squared = v * (2.0 - v);
    const double sine = std::sqrt(sine_squared);
    const double phi = 2.0 * std::numbers::pi * u.y;
    // Basis of Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
    const double sign = std::copysign(1.0, axis.z);
    const double a = -1.0 / (sign + axis.z);
    const double b = axis.x * axis.y * a;
    const V3d tangent(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x);
    const V3d bitangent(b, sign + axis.y * axis.y * a, -axis.y);
    return {axis * (1.0 - v) + tangent * (sine * std::cos(phi)) + bitangent * (sine * std::sin(phi)), 1.0 - v,
            sine_squared};
  }
};

}  // namespace becalm::tracer
