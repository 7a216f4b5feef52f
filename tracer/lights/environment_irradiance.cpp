#include "tracer/lights/environment_irradiance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace becalm::tracer {

using std::numbers::pi;

LowHarmonics::Coefficients LowHarmonics::at(const V3d& dir) {
  static const double c0 = 0.5 / std::sqrt(pi), c1 = std::sqrt(3.0) * c0, c2 = std::sqrt(15.0) * c0,
                      c20 = 0.5 * std::sqrt(5.0) * c0;
  const double x = dir.x, y = dir.y, z = dir.z;
  return {c0,
          c1 * y,
          c1 * z,
          c1 * x,
          c2 * x * y,
          c2 * y * z,
          c2 * x * z,
          c20 * (3.0 * z * z - 1.0),
          0.5 * c2 * (x * x - y * y)};
}

double LowHarmonics::cosine_integral(const V3d& normal) const {
  const Coefficients basis = at(normal);
  const auto part = [&](std::size_t from, std::size_t to) {
    double sum = 0.0;
    for (std::size_t i = from; i < to; ++i) sum += coefficients_[i] * basis[i];
    return sum;
  };
  return pi * part(0, 1) + 2.0 * pi / 3.0 * part(1, 4) + 0.25 * pi * part(4, 9);
}

double LowHarmonics::integral() const {
  return 2.0 * std::sqrt(pi) * coefficients_[0];
}

EnvironmentIrradiance::Arriving EnvironmentIrradiance::at(const Receiver& receiver) const {
  // The harmonics ring: where little light comes from, a share of the mean is assumed.
  constexpr double least_share = 0.05;
  const double whole = total();
  double irradiance = whole, squares = squared_.integral() * 4.0 * pi;
  if (receiver.faces()) {
    const V3d normal(receiver.normal);
    irradiance = std::max(radiance_.cosine_integral(normal), 0.25 * least_share * whole);
    squares = std::max(squared_.cosine_integral(normal), 0.25 * least_share * squared_.integral()) * pi;
  }
  // The square may be infinite: all of the light comes from a few directions then.
  return {irradiance, squares > 0.0 ? std::clamp(1.0 - irradiance * irradiance / squares, 0.0, 1.0) : 0.0};
}

}  // namespace becalm::tracer
