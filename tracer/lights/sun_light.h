#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "tracer/lights/cone.h"
#include "tracer/lights/irradiance.h"
#include "tracer/lights/light_sample.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

/// A disc at infinity of uniform radiance, or a direction alone.
struct SunLight {
  V3f direction;       ///< towards the sun; any length but 0
  float diameter_deg;  ///< in [0, 180]; the sun's own is 0.53
  V3f irradiance;      ///< on a surface that faces it, W/m^2
  std::uint16_t group = 0;
};

/// A sun, prepared for sampling. It is a delta direction below 1e-4 degrees, which directions in float do not
/// resolve, and where the disc's radiance would leave the range of float (1e30 W/m^2 from 1e-4 degrees).
struct SunEmitter {
  Cone disc;            ///< rim 0: delta; axis 0 without a direction
  double sine_squared;  ///< of the disc's angular radius
  V3f irradiance;
  V3f radiance;  ///< of the disc; 0 if delta
  std::uint16_t group;

  explicit SunEmitter(const SunLight& sun)
      : disc{V3d(sun.direction).normalized(), 0.0},
        sine_squared(0.0),
        irradiance(sun.irradiance),
        radiance(0.0f),
        group(sun.group) {
    constexpr float smallest_diameter_deg = 1e-4f;
    if (!(sun.diameter_deg >= smallest_diameter_deg)) return;
    const double radius = 0.5 * sun.diameter_deg * std::numbers::pi / 180.0;
    const double sine = std::sin(radius);
    // A surface that faces the disc receives its radiance times the integral of the cosine over it.
    const V3d disc_radiance = V3d(irradiance) / (std::numbers::pi * sine * sine);
    if (!(std::max({disc_radiance.x, disc_radiance.y, disc_radiance.z}) <= std::numeric_limits<float>::max()))
      return;
    disc.rim = versine(radius);
    sine_squared = sine * sine;
    radiance = V3f(disc_radiance);
  }

  bool delta() const { return disc.rim == 0.0; }

  /// Whether it has a direction, and something finite to send from there.
  bool shines() const {
    const double mean = channel_mean(irradiance);
    return has_direction(disc.axis) && mean > 0.0 && std::isfinite(mean);
  }

  /// What arrives at the receiver if nothing is in between, as irradiance.h has it.
  double irradiance_at(const Receiver& at) const {
    const double mean = channel_mean(irradiance);
    if (!at.faces()) return mean;
    const double cosine = V3d(at.normal).dot(disc.axis);
    if (delta()) return mean * std::max(0.0, cosine);
    return mean * sphere_irradiance(std::sqrt(sine_squared), cosine) / (std::numbers::pi * sine_squared);
  }

  /// Whether the unit direction points at the disc.
  bool contains(const V3f& dir_world) const {
    if (delta()) return false;
    const V3d dir(dir_world);
    // By the sine, since the cosine of 0.01 degrees is 1 within float, and so that the rounded length of
    // dir_world does not matter.
    return dir.dot(disc.axis) > 0.0 && dir.cross(disc.axis).length2() <= sine_squared * dir.length2();
  }

  /// Density per solid angle of the directions in the disc.
  float pdf_solid_angle() const { return static_cast<float>(1.0 / disc.solid_angle()); }

  LightSample sample(const V2f& u) const {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    if (delta()) return {V3f(disc.axis), infinity, irradiance, 1.0f, group, true};
    return {V3f(disc.sample(u).dir), infinity, radiance, pdf_solid_angle(), group, false};
  }
};

}  // namespace becalm::tracer
