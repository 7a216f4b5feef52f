#pragma once

#include <cmath>

#include "tracer/math/vec.h"

namespace becalm::tracer {

// Helpers for directions in the shading frame.

/// Whether wo and wi lie on the same side of the surface, neither tangential.
inline bool same_side(const V3f& wo, const V3f& wi) {
  return wo.z * wi.z > 0.0f;
}

/// The direction mirrored at the shading plane when it lies below: models that act on both sides compute
/// above.
inline V3f upper(const V3f& w) {
  return {w.x, w.y, std::abs(w.z)};
}

/// w mirrored at the unit normal m.
inline V3f reflect(const V3f& w, const V3f& m) {
  return m * (2.0f * w.dot(m)) - w;
}

}  // namespace becalm::tracer
