#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Where a ray meets a shape, in the shape's space.
struct LocalHit {
  float distance;  ///< in multiples of the ray's direction
  V3f point;
};

/// The first distance in (0, t_max) at which the ray meets the sphere of radius 1 around the origin, from
/// either side.
///
/// Source: Haines, Günther and Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", Ray
/// Tracing Gems, 2019, chapter 7: the discriminant from the vector to the point of closest approach, and the
/// nearer root from the product of both. Instances that flatten a sphere make rays so long in its space that
/// floats do not tell where they pass it, nor the sum of origin and distance where they meet it.
inline std::optional<LocalHit> intersect_unit_sphere(const V3f& ray_origin, const V3f& ray_dir, float t_max) {
  const V3d origin(ray_origin), dir(ray_dir);
  const double a = dir.dot(dir);
  double t_approach = -origin.dot(dir) / a;
  V3d approach = origin + dir * t_approach;
  const double correction = -approach.dot(dir) / a;  // of what the long sum has rounded
  approach += dir * correction;
  t_approach += correction;
  const double rest = 1.0 - approach.dot(approach);
  if (!(rest >= 0.0)) return std::nullopt;
  const double half_chord = std::sqrt(rest / a);
  const double distance = origin.length();
  const double product = (distance - 1.0) * (distance + 1.0) / a;  // of both roots
  // The root of larger magnitude has no cancellation, the other follows from it.
  const double outer = t_approach + std::copysign(half_chord, t_approach);
  const double inner = outer != 0.0 ? product / outer : 0.0;
  const double nearer = std::min(outer, inner), farther = std::max(outer, inner);
  const auto hit = [&](double t, double along_chord) -> LocalHit {
    return {static_cast<float>(t), V3f(approach + dir * along_chord)};
  };
  const auto is_on_ray = [&](double t) {
    return static_cast<float>(t) > 0.0f && static_cast<float>(t) < t_max;
  };
  if (is_on_ray(nearer)) return hit(nearer, -half_chord);
  if (is_on_ray(farther)) return hit(farther, half_chord);
  return std::nullopt;
}

}  // namespace becalm::tracer
