#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tracer/lights/receiver.h"
#include "tracer/math/vec.h"

// What emitters send to a receiver if nothing is in between, as weights of the choice among them: irradiance,
// or, where the receiver has no normal, fluence.

namespace becalm::tracer {

/// Least squared distance that counts: weights stay finite.
inline constexpr double kLeastSquaredDistance = 1e-80;

/// Of a sphere of radiance 1 whose outline is `sine` off its centre, seen under `cosine` to the receiver's
/// normal. Exact where the sphere is above the horizon or below it; in between a smooth curve that joins
/// both.
inline double sphere_irradiance(double sine, double cosine) {
  if (cosine >= sine) return std::numbers::pi * sine * sine * cosine;
  if (cosine <= -sine) return 0.0;
  const double above = cosine + sine;
  return 0.25 * std::numbers::pi * sine * above * above;
}

/// Of the same sphere, for a receiver without normal: its solid angle.
inline double sphere_fluence(double sine) {
  const double sine_squared = std::min(1.0, sine * sine);
  return 2.0 * std::numbers::pi * sine_squared / (1.0 + std::sqrt(1.0 - sine_squared));
}

/// Of an emitter so small that it has an intensity in the direction of the receiver, `to_light` away.
inline double point_irradiance(const Receiver& at, const V3d& to_light, double intensity) {
  const double squared = std::max(to_light.length2(), kLeastSquaredDistance);
  if (!at.faces()) return intensity / squared;
  return intensity * std::max(0.0, V3d(at.normal).dot(to_light)) / (squared * std::sqrt(squared));
}

/// Of an emitter of radiance 1 whose vector irradiance is pi times `sine_squared` and points in the unit
/// direction: that of a sphere with the same.
inline double irradiance_of_outline(const Receiver& at, double sine_squared, const V3d& dir) {
  const double sine = std::sqrt(sine_squared);
  if (!at.faces()) return sphere_fluence(sine);
  // What the sphere misses at the horizon must still be drawn at times.
  constexpr double least_cosine = 0.05;
  return sphere_irradiance(sine, std::max(V3d(at.normal).dot(dir), least_cosine - sine));
}

/// Of a polygon of radiance 1 whose corners are this far away from the receiver, in order, two of which may
/// coincide: by its vector irradiance (Lambert's formula), which is exact where all of the polygon is above
/// the horizon.
double polygon_irradiance(const Receiver& at, const std::array<V3d, 4>& corners);

}  // namespace becalm::tracer
