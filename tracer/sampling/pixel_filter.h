#pragma once

#include "frame/jitter.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Separable filter around the pixel centre, zero beyond radius_px in x or y. The default covers 3x3 pixels.
struct PixelFilter {
  FilterShape type = FilterShape::blackman_harris;
  float radius_px = 1.5f;
};

/// Offset from the pixel centre in pixels, distributed as the filter's weight (which is positive), so that
/// all samples weigh the same and pixels share none. Monotone in each coordinate of u: stratification
/// survives. Source: Ernst et al., "Filter Importance Sampling", 2006.
V2f sample(const PixelFilter& filter, const V2f& u);

}  // namespace becalm::tracer
