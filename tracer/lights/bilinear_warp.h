#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// A density on the unit square that is bilinear between weights at its corners, and the monotone map that
/// draws from it. Source: Hart et al., "Practical Product Sampling by Fitting and Composing Warps", 2020.
class BilinearWarp {
 public:
  /// Positive weights at (0,0), (1,0), (0,1), (1,1).
  explicit BilinearWarp(const std::array<double, 4>& weights) : w_(weights) {}

  V2d sample(const V2f& u) const {
    const double x = linear(u.x, w_[0] + w_[2], w_[1] + w_[3]);
    return {x, linear(u.y, mix(w_[0], w_[1], x), mix(w_[2], w_[3], x))};
  }

  double density(const V2d& p) const {
    return 4.0 * mix(mix(w_[0], w_[1], p.x), mix(w_[2], w_[3], p.x), p.y) / (w_[0] + w_[1] + w_[2] + w_[3]);
  }

 private:
  static double mix(double a, double b, double t) { return a + t * (b - a); }
  /// From a density that is linear between a at 0 and b at 1.
  static double linear(double u, double a, double b) {
    return std::min(1.0, u * (a + b) / (a + std::sqrt(mix(a * a, b * b, u))));
  }

  std::array<double, 4> w_;
};

}  // namespace becalm::tracer
