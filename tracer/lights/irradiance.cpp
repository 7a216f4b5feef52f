#include "tracer/lights/irradiance.h"

namespace becalm::tracer {

namespace {

/// 4 numbers or coordinates, in float and written so that compilers make vector instructions of the loops:
/// the choice among lights needs no more digits.
using Four = std::array<float, 4>;

/// An angle over its sine, by its cosine; to 2e-5. Source: Hill and Heitz, "Real-Time Area Lighting: a
/// Journey from Research to Production", 2016.
Four angles_over_sines(const Four& cosines) {
  constexpr float two_pi = 2.0f * std::numbers::pi_v<float>;
  Four ratios;
  for (std::size_t i = 0; i < 4; ++i) {
    const float x = std::min(std::abs(cosines[i]), 1.0f);
    const float acute =
        (0.8543985f + (0.4965155f + 0.0145206f * x) * x) / (3.4175940f + (4.1616724f + x) * x);
    const float obtuse = 0.5f / std::sqrt(std::max(1.0f - x * x, 1e-7f)) - acute;
    ratios[i] = two_pi * (cosines[i] > 0.0f ? acute : obtuse);
  }
  return ratios;
}

}  // namespace

double polygon_irradiance(const Receiver& at, const std::array<V3d, 4>& corners) {
  Four x, y, z;
  for (std::size_t i = 0; i < 4; ++i) {
    x[i] = static_cast<float>(corners[i].x);
    y[i] = static_cast<float>(corners[i].y);
    z[i] = static_cast<float>(corners[i].z);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    constexpr float least_squared = 1e-36f;
    const float inverse = 1.0f / std::sqrt(std::max(x[i] * x[i] + y[i] * y[i] + z[i] * z[i], least_squared));
    x[i] *= inverse;
    y[i] *= inverse;
    z[i] *= inverse;
  }
  Four next_x, next_y, next_z, cosines;
  for (std::size_t i = 0; i < 4; ++i) {
    next_x[i] = x[(i + 1) % 4];
    next_y[i] = y[(i + 1) % 4];
    next_z[i] = z[(i + 1) % 4];
  }
  for (std::size_t i = 0; i < 4; ++i) cosines[i] = x[i] * next_x[i] + y[i] * next_y[i] + z[i] * next_z[i];
  const Four ratios = angles_over_sines(cosines);
  V3f flux(0.0f), center(0.0f);
  for (std::size_t i = 0; i < 4; ++i) {
    flux.x += (y[i] * next_z[i] - z[i] * next_y[i]) * ratios[i];
    flux.y += (z[i] * next_x[i] - x[i] * next_z[i]) * ratios[i];
    flux.z += (x[i] * next_y[i] - y[i] * next_x[i]) * ratios[i];
    center += {x[i], y[i], z[i]};
  }
  const double length = 0.5 * std::sqrt(static_cast<double>(flux.dot(flux)));
  if (!(length > 0.0)) return 0.0;
  const double scale = std::copysign(0.5 / length, flux.dot(center));
  return irradiance_of_outline(at, std::min(1.0, length / std::numbers::pi), V3d(flux) * scale);
}

}  // namespace becalm::tracer
