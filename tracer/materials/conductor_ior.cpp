#include "tracer/materials/conductor_ior.h"

#include <algorithm>
#include <cmath>

namespace becalm::tracer {

ConductorIor conductor_from_reflectance(const V3f& reflectance) {
  ConductorIor ior{V3f(1.0f), V3f(0.0f)};
  for (int c = 0; c < 3; ++c) {
    // At normal incidence R = k^2 / (4 + k^2) when eta is 1.
    const double r = std::clamp(reflectance[c], 0.0f, 1.0f);
    if (r < 1.0) {
      ior.k[c] = static_cast<float>(2.0 * std::sqrt(r / (1.0 - r)));
    } else {
      ior.eta[c] = 0.0f;
      ior.k[c] = 1.0f;
    }
  }
  return ior;
}

}  // namespace becalm::tracer
