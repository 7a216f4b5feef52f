#include "tracer/scene/transform.h"

#include <numbers>

namespace becalm::tracer {

namespace {

M44d rotation(int axis, double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0;
  const double c = std::cos(angle), s = std::sin(angle);
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  M44d m;  // row vectors: the row of an axis is its image
  m[i][i] = c;
  m[i][j] = s;
  m[j][i] = -s;
  m[j][j] = c;
  return m;
}

}  // namespace

M44d transform_at(const TransformCurve& curve, double frame) {
  const TransformCurve::Value v = curve.at(frame);
  M44d m;
  for (int axis = 0; axis < 3; ++axis) m[axis][axis] = v[6 + axis];
  for (int axis = 0; axis < 3; ++axis) {
    if (v[3 + axis] != 0.0) m = m * rotation(axis, v[3 + axis]);
  }
  for (int axis = 0; axis < 3; ++axis) m[3][axis] = v[axis];
  return m;
}

V3d rotation_angles_deg(const M44d& m) {
  // Rows are the axes' images: x becomes (cos y cos z, cos y sin z, -sin y).
  const double cos_y = std::hypot(m[0][0], m[0][1]);
  const double y = std::atan2(-m[0][2], cos_y);
  // Looking along the turned x axis only the difference of the other two angles counts.
  const bool locked = cos_y < 1e-9;
  const double x = locked ? std::atan2(-m[2][1], m[1][1]) : std::atan2(m[1][2], m[2][2]);
  const double z = locked ? 0.0 : std::atan2(m[0][1], m[0][0]);
  return V3d(x, y, z) * (180.0 / std::numbers::pi);
}

LookAt look_at(const LookAtCurve& curve, double frame) {
  const LookAtCurve::Value v = curve.at(frame);
  return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}};
}

bool is_valid(const LookAt& look_at) {
  const V3d view = look_at.target - look_at.eye;
  return view.length() > 0.0 && view.cross(look_at.up).length() > 1e-9 * view.length() * look_at.up.length();
}

}  // namespace becalm::tracer
