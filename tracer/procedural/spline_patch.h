#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace becalm::tracer {

/// Height and its derivatives along two axes.
struct HeightSlope {
  float height, slope_x, slope_z;
};

/// One cell of a uniform biquadratic B-spline surface, over (u, v) in [0,1]^2: C1 across cells, within the
/// convex hull of its nine controls.
struct SplinePatch {
  /// The cell whose first control (of those with the least coordinates) is `*first`, in rows of `stride`.
  SplinePatch(const float* first, std::size_t stride) {
    for (std::size_t j = 0; j < 3; ++j) std::copy_n(first + j * stride, 3, c + 3 * j);
  }

  /// Slopes are by u and v.
  HeightSlope at(float u, float v) const {
    const float u0 = 0.5f * (1.0f - u) * (1.0f - u), u2 = 0.5f * u * u, u1 = 1.0f - u0 - u2;
    const float v0 = 0.5f * (1.0f - v) * (1.0f - v), v2 = 0.5f * v * v, v1 = 1.0f - v0 - v2;
    const float r0 = u0 * c[0] + u1 * c[1] + u2 * c[2];
    const float r1 = u0 * c[3] + u1 * c[4] + u2 * c[5];
    const float r2 = u0 * c[6] + u1 * c[7] + u2 * c[8];
    const float x0 = (1.0f - u) * (c[1] - c[0]) + u * (c[2] - c[1]);
    const float x1 = (1.0f - u) * (c[4] - c[3]) + u * (c[5] - c[4]);
    const float x2 = (1.0f - u) * (c[7] - c[6]) + u * (c[8] - c[7]);
    return {v0 * r0 + v1 * r1 + v2 * r2, v0 * x0 + v1 * x1 + v2 * x2, (1.0f - v) * (r1 - r0) + v * (r2 - r1)};
  }

  /// Bound of the second derivative along the direction (du, dv), anywhere in the cell: each of the three
  /// second derivatives is a convex combination of differences of controls.
  float curvature(float du, float dv) const {
    float uu = 0.0f, vv = 0.0f, uv = 0.0f;
    for (int k = 0; k < 3; ++k) {
      uu = std::max(uu, std::abs(c[3 * k] - 2.0f * c[3 * k + 1] + c[3 * k + 2]));
      vv = std::max(vv, std::abs(c[k] - 2.0f * c[k + 3] + c[k + 6]));
    }
    for (const int k : {0, 1, 3, 4}) uv = std::max(uv, std::abs(c[k] - c[k + 1] - c[k + 3] + c[k + 4]));
    return uu * du * du + 2.0f * uv * std::abs(du * dv) + vv * dv * dv;
  }

  float c[9];
};

}  // namespace becalm::tracer
