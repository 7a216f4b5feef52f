#include "tracer/lights/light_bounds.h"

#include <algorithm>
#include <cmath>

namespace becalm::tracer {

using std::numbers::pi;

DirectionBounds unite(const DirectionBounds& a, const DirectionBounds& b) {
  if (a.angle_rad < b.angle_rad) return unite(b, a);
  if (a.angle_rad >= pi) return a;
  const V3d cross = a.axis.cross(b.axis);
  const double between = std::atan2(cross.length(), a.axis.dot(b.axis));
  if (std::min(between + b.angle_rad, pi) <= a.angle_rad) return a;
  const double angle = 0.5 * (a.angle_rad + between + b.angle_rad);
  const V3d turn_axis = cross.normalized();
  if (angle >= pi || turn_axis == V3d(0.0)) return {a.axis, pi};
  // Rotates a.axis about turn_axis, which is perpendicular to it.
  const double turn = angle - a.angle_rad;
  return {a.axis * std::cos(turn) + turn_axis.cross(a.axis) * std::sin(turn), angle};
}

LightBounds unite(const LightBounds& a, const LightBounds& b) {
  if (a.intensity == 0.0) return b;
  if (b.intensity == 0.0) return a;
  LightBounds both = a;
  both.box.extendBy(b.box);
  both.facing = unite(a.facing, b.facing);
  both.emission_rad = std::max(a.emission_rad, b.emission_rad);
  both.two_sided = a.two_sided || b.two_sided;
  both.intensity = a.intensity + b.intensity;
  return both;
}

double cluster_cost(const LightBounds& bounds) {
  const double o = bounds.facing.angle_rad;
  const double w = std::min(o + bounds.emission_rad, pi);
  const double directions =
      2.0 * pi * (1.0 - std::cos(o)) +
      0.5 * pi * (2.0 * w * std::sin(o) - std::cos(o - 2.0 * w) - 2.0 * o * std::sin(o) + std::cos(o));
  return bounds.intensity * directions * bounds.box.size().length2();
}

}  // namespace becalm::tracer
