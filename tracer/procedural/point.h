#pragma once

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// A point of a procedural surface, in object space.
struct ProceduralPoint {
  V3f position;  ///< on the surface
  V3f normal;    ///< outward (up), of length 1; of the surface as averaged over the footprint
  V2f uv;        ///< of terrain and ocean as the rectangle's: v grows towards -z
  /// A ray that starts this far from `position` along the unaveraged normal, or further, does not meet the
  /// surface again at once.
  float error;
  /// Variance of the slope (both axes together, about its mean) that averaging took out of the normal.
  /// Widening a microfacet lobe's alpha^2 by it keeps what the averaged slopes reflected.
  float slope_variance;
};

}  // namespace becalm::tracer
