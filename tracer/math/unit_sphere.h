#pragma once

#include <optional>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// The first distance in (0, t_max) at which the ray meets the sphere of radius 1 around the origin, from
/// either side, in multiples of `dir`.
///
/// Source: Haines, Günther and Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", Ray
/// Tracing Gems, 2019, chapter 7: the discriminant from the vector to the point of closest approach, and the
/// nearer root from the product of both.
inline std::optional<float> intersect_unit_sphere(const V3f& origin, const V3f& dir, float t_max) {
  const float a = dir.dot(dir);
  const float t_approach = -origin.dot(dir) / a;
  const V3f approach = origin + dir * t_approach;
  const float rest = 1.0f - approach.dot(approach);
  if (!(rest >= 0.0f)) return std::nullopt;
  const float half_chord = std::sqrt(rest / a);
  const float distance = origin.length();
  const float product = (distance - 1.0f) * (distance + 1.0f) / a;  // of both roots
  // The root of larger magnitude has no cancellation, the other follows from it.
  const float outer = t_approach + std::copysign(half_chord, t_approach);
  const float inner = outer != 0.0f ? product / outer : 0.0f;
  const float nearer = std::min(outer, inner), farther = std::max(outer, inner);
  if (nearer > 0.0f && nearer < t_max) return nearer;
  if (farther > 0.0f && farther < t_max) return farther;
  return std::nullopt;
}

}  // namespace becalm::tracer
