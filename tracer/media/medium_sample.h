#pragma once

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// What happened first on the way through a medium.
struct MediumSample {
  bool scattered;  ///< false: the way's end was reached
  float t;         ///< distance at which it scattered, below t_max; t_max otherwise
  /// What the path's throughput is multiplied by: transmittance(t) * scattering coefficient / density of t,
  /// or transmittance(t_max) / probability of getting there. Without the phase function. Finite, not
  /// negative.
  V3f weight;
};

}  // namespace becalm::tracer
