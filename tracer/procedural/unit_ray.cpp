#include "tracer/procedural/unit_ray.h"

namespace becalm::tracer {

std::optional<UnitRay> clip_ray(const V3f& origin, const V3f& dir, float t_min, float t_max, double unit,
                                const Imath::Box3f& box) {
  if (!is_finite(origin) || !is_finite(dir)) return std::nullopt;
  const V3d d_object(dir.x, dir.y, dir.z);
  const double length = std::sqrt(d_object.dot(d_object));
  if (!(length > 0.0) || !(t_min <= t_max)) return std::nullopt;
  const double per_unit = unit / length;
  const V3d d = d_object / length, o = V3d(origin.x, origin.y, origin.z) / unit;
  // Infinite t are allowed; their products with a tiny length must not become NaN.
  double t0 = t_min / per_unit, t1 = t_max / per_unit;
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == 0.0) {
      if (o[axis] < box.min[axis] || o[axis] > box.max[axis]) return std::nullopt;
      continue;
    }
    const double a = (box.min[axis] - o[axis]) / d[axis], b = (box.max[axis] - o[axis]) / d[axis];
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }
  if (!(t0 <= t1)) return std::nullopt;
  const V3d entry = o + t0 * d;
  return UnitRay{V3f(entry), V3f(d), static_cast<float>(t1 - t0), t0, per_unit};
}

}  // namespace becalm::tracer
