#pragma once

#include <algorithm>
#include <cmath>

namespace becalm::tracer {

/// Which side of a surface a ray runs on: above or outside (+1), below or inside (-1), or not known yet.
enum class Side : int { below = -1, unknown = 0, above = 1 };

/// The side on which a field has that value.
inline Side side_of(float value) {
  return value >= 0.0f ? Side::above : Side::below;
}

/// What is known of a field ahead of one t of a ray, counted positive on the ray's side. At t + dt it is at
/// least
///   value + slope dt - curvature dt^2 / 2   and   value + slope dt + second dt^2 / 2 - third dt^3 / 6.
struct Ahead {
  float value, slope, curvature;
  float second = -HUGE_VALF;  ///< second derivative; none known by default
  float third = 0.0f;
};

/// Where the parabola value + slope dt - curvature dt^2 / 2 has its first root; value > 0.
inline float first_root_of_parabola(float value, float slope, float curvature) {
  const float squared = slope * slope + 2.0f * curvature * value;
  if (squared < 0.0f) return HUGE_VALF;
  const float denominator = std::sqrt(squared) - slope;
  return denominator > 0.0f ? 2.0f * value / denominator : HUGE_VALF;
}

/// A dt before which the bounds have no root; value > 0. Near a root of the field it is Newton's step up to
/// second order, or third where the second derivative is known: a march by it converges fast and never passes
/// the first root.
inline float safe_step(const Ahead& ahead) {
  const float sure = first_root_of_parabola(ahead.value, ahead.slope, ahead.curvature);
  // Up to `reach` the cubic lies above the parabola that has the cubic's largest curvature there.
  const float reach = 3.0f * sure;
  const float curvature = ahead.third * reach * (1.0f / 3.0f) - ahead.second;
  if (!(curvature < ahead.curvature)) return sure;
  return std::min(reach, first_root_of_parabola(ahead.value, ahead.slope, curvature));
}

/// Advances t, which is less than t1, along a ray. Returns true at the first t where the field changes its
/// side or is within `tolerance` of 0, and false at a t of t1 or more before which there is none. `look(t,
/// side)` returns what is Ahead, and sets the side if it is unknown; a value within the tolerance must be the
/// field's own and no lower bound.
template <class Look>
bool march(const Look& look, float& t, float t1, float tolerance, Side& side) {
  while (t < t1) {
    const Ahead ahead = look(t, side);
    if (!(ahead.value > tolerance)) return true;
    const float next = t + safe_step(ahead);
    if (next == t) return true;  // closer than t can tell
    t = next;
  }
  return false;
}

}  // namespace becalm::tracer
