#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// The rectangle [x0,x1] x [y0,y1] of a plane, seen from `height` > 0 above the plane's origin: a map from
/// the unit square that is uniform by solid angle.
///
/// Source: Urena, Fajardo and King, "An Area-Preserving Parametrization for Spherical Rectangles", 2013.
/// Differs from the paper: the solid angle of [0,x] x [0,y] is the argument of a complex number, so that sums
/// of them are products, and the whole takes one arctangent.
class SphericalRectangle {
 public:
  SphericalRectangle(double x0, double x1, double y0, double y1, double height)
      : x0_(x0), x1_(x1), y0_(y0), y1_(y1), height_(height), squared_(height * height) {
    const double x0_squared = x0 * x0 + squared_, x1_squared = x1 * x1 + squared_;
    distances_ = {std::sqrt(x0_squared + y0 * y0), std::sqrt(x1_squared + y0 * y0),
                  std::sqrt(x0_squared + y1 * y1), std::sqrt(x1_squared + y1 * y1)};
    start_ = over(corner(x0, y1, distances_[2]), corner(x0, y0, distances_[0]));
    const double scale = 1.0 / std::sqrt(start_.cosine * start_.cosine + start_.sine * start_.sine);
    start_ = {start_.cosine * scale, start_.sine * scale};
    const Turn end = over(corner(x1, y1, distances_[3]), corner(x1, y0, distances_[1]));
    const Turn whole = over(end, start_);
    solid_angle_ = std::atan2(whole.sine, whole.cosine);
    if (solid_angle_ < 0.0) solid_angle_ += 2.0 * std::numbers::pi;
  }

  /// Not positive where rounding leaves nothing.
  double solid_angle() const { return solid_angle_; }

  /// Of the corners (x0,y0), (x1,y0), (x0,y1), (x1,y1).
  const std::array<double, 4>& distances() const { return distances_; }

  /// The point of the plane: u.x turns into x, u.y into y.
  V2d sample(const V2d& u) const {
    // By the cosine rule on the sphere, with the solid angle t of [0,x] x [y0,y1] and h = sqrt(y^2 +
    // height^2): y1/h1 - cos t y0/h0 = sin t sqrt(x^2 + height^2) / x.
    const double part = u.x * solid_angle_;
    const Turn t = times(start_, {std::cos(part), std::sin(part)});
    const double h0_squared = y0_ * y0_ + squared_;
    const double f = y1_ / std::sqrt(y1_ * y1_ + squared_) - t.cosine * y0_ / std::sqrt(h0_squared);
    const double root = f * f - squared_ / h0_squared * t.sine * t.sine;
    const double x = root > 0.0 ? height_ * t.sine / std::sqrt(root) : std::copysign(kBeyond, t.sine);
    const double inside = std::clamp(x, x0_, x1_);
    // y is uniform by the sine of its angle.
    const double d_squared = inside * inside + squared_;
    const double sine0 = sine_of(y0_, d_squared);
    const double sine_y = sine0 + u.y * (sine_of(y1_, d_squared) - sine0);
    const double y = sine_y * std::sqrt(d_squared / std::max((1.0 - sine_y) * (1.0 + sine_y), 1e-300));
    return {inside, std::clamp(y, y0_, y1_)};
  }

  /// The u that sample() turns into this point.
  V2d invert(const V2d& point) const {
    const double d_squared = point.x * point.x + squared_;
    const Turn end = over(corner(point.x, y1_, std::sqrt(d_squared + y1_ * y1_)),
                          corner(point.x, y0_, std::sqrt(d_squared + y0_ * y0_)));
    const Turn part = over(end, start_);
    double angle = std::atan2(part.sine, part.cosine);
    // Rounding may leave the start by a little on the wrong side.
    if (angle < -1e-6) angle += 2.0 * std::numbers::pi;
    const double sine0 = sine_of(y0_, d_squared);
    return {std::clamp(angle / solid_angle_, 0.0, 1.0),
            std::clamp((sine_of(point.y, d_squared) - sine0) / (sine_of(y1_, d_squared) - sine0), 0.0, 1.0)};
  }

 private:
  static constexpr double kBeyond = 1e300;

  /// A complex number, for its argument.
  struct Turn {
    double cosine;
    double sine;
  };
  static Turn times(const Turn& a, const Turn& b) {
    return {a.cosine * b.cosine - a.sine * b.sine, a.cosine * b.sine + a.sine * b.cosine};
  }
  static Turn over(const Turn& a, const Turn& b) { return times(a, {b.cosine, -b.sine}); }

  /// Turns by the solid angle of [0,x] x [0,y], which has the sign of x y.
  Turn corner(double x, double y, double distance) const { return {height_ * distance, x * y}; }

  static double sine_of(double y, double d_squared) { return y / std::sqrt(y * y + d_squared); }

  double x0_, x1_, y0_, y1_;
  double height_, squared_;
  std::array<double, 4> distances_;
  Turn start_;  ///< by the solid angle of [0,x0] x [y0,y1]; of length 1
  double solid_angle_;
};

}  // namespace becalm::tracer
