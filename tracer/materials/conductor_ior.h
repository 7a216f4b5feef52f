#pragma once

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// A metal's complex index of refraction, a channel each.
struct ConductorIor {
  V3f eta;
  V3f k;
};

/// The metal with eta = 1 that has exactly this reflectance at normal incidence; brightens to white at
/// grazing angles. Clamped to [0,1]; a channel of 1 reflects everything at every angle.
ConductorIor conductor_from_reflectance(const V3f& reflectance);

}  // namespace becalm::tracer
