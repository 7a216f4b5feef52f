#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// The triangle on the unit sphere between three directions: a map from the unit square that is uniform by
/// solid angle.
///
/// Source: Arvo, "Stratified Sampling of Spherical Triangles", 1995; the solid angle by Van Oosterom and
/// Strackee, 1983, which keeps its digits where the three angles' excess over pi would lose them.
class SphericalTriangle {
 public:
  /// Unit directions.
  SphericalTriangle(const V3d& a, const V3d& b, const V3d& c)
      : a_(a),
        b_(b),
        c_(c),
        solid_angle_(2.0 * std::atan2(std::abs(a.dot(b.cross(c))), 1.0 + a.dot(b) + b.dot(c) + c.dot(a))) {}

  double solid_angle() const { return solid_angle_; }

  V3d sample(const V2f& u) const {
    const V3d ab = a_.cross(b_), ac = a_.cross(c_);
    // The angle at a, not normalized; the part of the triangle that u.x cuts off ends at c' between a and c.
    const double scale = 1.0 / std::sqrt(ab.length2() * ac.length2());
    const double cos_a = ab.dot(ac) * scale;
    const double sin_a = ab.cross(ac).length() * scale;
    const double area = u.x * solid_angle_;
    const double sin_area = std::sin(area), cos_area = std::cos(area);
    const double s = sin_area * cos_a - cos_area * sin_a;
    const double t = cos_area * cos_a + sin_area * sin_a;
    const double p = t - cos_a;
    const double q = s + sin_a * a_.dot(b_);
    const double cosine = std::clamp(((q * t - p * s) * cos_a - q) / ((q * s + p * t) * sin_a), -1.0, 1.0);
    const V3d cut = a_ * cosine + perpendicular(c_, a_) * std::sqrt(1.0 - cosine * cosine);
    // Uniform by the cosine to b on the arc from b to c'.
    const double v = u.y * 0.5 * (cut - b_).length2();  // versine
    return b_ * (1.0 - v) + perpendicular(cut, b_) * std::sqrt(std::max(0.0, v * (2.0 - v)));
  }

 private:
  /// The unit direction perpendicular to `axis` on the way to `to`.
  static V3d perpendicular(const V3d& to, const V3d& axis) { return (to - axis * to.dot(axis)).normalized(); }

  V3d a_, b_, c_;
  double solid_angle_;
};

}  // namespace becalm::tracer
