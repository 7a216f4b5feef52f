#pragma once

#include <Imath/ImathBox.h>

#include <optional>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// A ray clipped to a box, in the units of a field whose extent is about 1, from where it enters: what is
/// marched there in float loses nothing to far origins or to large and small objects.
struct UnitRay {
  V3f origin;       ///< at the entry
  V3f dir;          ///< of length 1
  float t_end;      ///< where the ray leaves
  double t_entry;   ///< the entry's distance from the given origin, in unit lengths
  double per_unit;  ///< multiples of the given direction in a unit length

  /// t of the given ray.
  float outer_t(float t) const { return static_cast<float>((t_entry + t) * per_unit); }
};

/// The part of origin + t dir, t in [t_min, t_max], inside `box`, both divided by `unit`. None if there is
/// none, or for a ray that is not finite or has no direction.
std::optional<UnitRay> clip_ray(const V3f& origin, const V3f& dir, float t_min, float t_max, double unit,
                                const Imath::Box3f& box);

}  // namespace becalm::tracer
