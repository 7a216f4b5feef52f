#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "tracer/math/vec.h"

namespace becalm::tracer {

// Tables of albedos by linear interpolation. Axes of cosines and of widths are by their square roots, since
// albedos bend where the cosine is about alpha.

/// Added to albedos: more than the largest errors of interpolation, so that no material returns more light
/// than it receives. What should return all loses as much.
inline constexpr float kAlbedoMargin = 0.003f;

/// Between which nodes of an axis a place lies.
struct TablePosition {
  int index;  ///< of the lower one
  float fraction;

  float mix(float low, float high) const { return low + fraction * (high - low); }
};

/// Of v in [0,1] on an axis of that many evenly spaced nodes.
inline TablePosition table_position(float v, int nodes) {
  const float x = v * static_cast<float>(nodes - 1);
  const int index = std::min(static_cast<int>(x), nodes - 2);
  return {index, x - static_cast<float>(index)};
}

/// The value of a node on an axis by roots.
inline float squared_node(int index, int nodes) {
  const float root = static_cast<float>(index) / static_cast<float>(nodes - 1);
  return root * root;
}

/// Weights of the nodes of a cosine's axis in the mean over the hemisphere, weighed by the cosine: exact for
/// what is interpolated. 2 int E(cos) cos dcos = 4 int E(x^2) x^3 dx, x the root of the cosine, and E linear
/// between the nodes: in each interval a polynomial of degree 4, for which three points of Gauss are exact.
template <int kNodes>
std::array<double, kNodes> cosine_weights() {
  std::array<double, kNodes> weights{};
  constexpr double step = 1.0 / (kNodes - 1);
  for (int j = 0; j + 1 < kNodes; ++j) {
    for (const int k : {-1, 0, 1}) {
      const double t = 0.5 + 0.5 * k * 0.7745966692414834;
      const double x = (j + t) * step;
      const double weight = 4.0 * (k == 0 ? 4.0 / 9.0 : 5.0 / 18.0) * step * x * x * x;
      weights[j] += weight * (1.0 - t);
      weights[j + 1] += weight * t;
    }
  }
  return weights;
}

/// Points of the unit square to integrate over; what is integrated is periodic in the first number, the
/// azimuth. Fibonacci lattices: `points` is a Fibonacci number, `before` the one before.
struct Lattice {
  int points;
  int before;

  V2f point(int i) const {
    const auto count = static_cast<float>(points);
    return {static_cast<float>(i * before % points) / count, (static_cast<float>(i) + 0.5f) / count};
  }
};

}  // namespace becalm::tracer
