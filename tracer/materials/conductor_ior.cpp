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

ConductorIor conductor_from_reflectance(const V3f& reflectance, const V3f& edge_tint) {
  ConductorIor ior = conductor_from_reflectance(reflectance);
  for (int c = 0; c < 3; ++c) {
    const double r = std::clamp(reflectance[c], 0.0f, 1.0f);
    if (r == 1.0) continue;
    // Gulbrandsen's eq. 10 and 8: eta between the smallest and the largest that reflect r at all, then k from
    // r.
    const double tint = std::clamp(edge_tint[c], 0.0f, 1.0f);
    const double root = std::sqrt(r);
    const double eta = tint * (1.0 - r) / (1.0 + r) + (1.0 - tint) * (1.0 + root) / (1.0 - root);
    const double k2 = (r * (eta + 1.0) * (eta + 1.0) - (eta - 1.0) * (eta - 1.0)) / (1.0 - r);
    ior.eta[c] = static_cast<float>(eta);
    ior.k[c] = static_cast<float>(std::sqrt(std::max(0.0, k2)));
  }
  return ior;
}

}  // namespace becalm::tracer
