#pragma once

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>

namespace becalm::tracer {

using Imath::M44d;
using Imath::M44f;
using Imath::V2d;
using Imath::V2f;
using Imath::V3d;
using Imath::V3f;

inline float max_component(const V3f& v) {
  return std::max({v.x, v.y, v.z});
}
/// Of any sign.
inline float largest_coordinate(const V3f& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}
inline bool is_black(const V3f& v) {
  return v.x == 0.0f && v.y == 0.0f && v.z == 0.0f;
}
inline bool is_finite(const V3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Imath's matrices act on row vectors (p' = p M); these spell out which kind of vector is meant.
template <class T>
Imath::Vec3<T> transform_point(const Imath::Vec3<T>& p, const Imath::Matrix44<T>& m) {
  return {p.x * m[0][0] + p.y * m[1][0] + p.z * m[2][0] + m[3][0],
          p.x * m[0][1] + p.y * m[1][1] + p.z * m[2][1] + m[3][1],
          p.x * m[0][2] + p.y * m[1][2] + p.z * m[2][2] + m[3][2]};
}
template <class T>
Imath::Vec3<T> transform_vector(const Imath::Vec3<T>& v, const Imath::Matrix44<T>& m) {
  return {v.x * m[0][0] + v.y * m[1][0] + v.z * m[2][0], v.x * m[0][1] + v.y * m[1][1] + v.z * m[2][1],
          v.x * m[0][2] + v.y * m[1][2] + v.z * m[2][2]};
}

}  // namespace becalm::tracer
