#pragma once

#include <array>

#include "tracer/lights/receiver.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

/// A function on the sphere by its nine lowest spherical harmonics.
class LowHarmonics {
 public:
  using Coefficients = std::array<double, 9>;

  LowHarmonics() = default;
  explicit LowHarmonics(const Coefficients& coefficients) : coefficients_(coefficients) {}

  /// The harmonics themselves in a unit direction.
  static Coefficients at(const V3d& dir);

  /// Integral over the hemisphere around the normal, weighted by the cosine, to a few per cent of the
  /// largest. Source: Ramamoorthi and Hanrahan, "An Efficient Representation for Irradiance Environment
  /// Maps", 2001.
  double cosine_integral(const V3d& normal) const;

  /// Integral over the sphere.
  double integral() const;

 private:
  Coefficients coefficients_{};
};

/// What an environment sends to a receiver if nothing is in between.
class EnvironmentIrradiance {
 public:
  EnvironmentIrradiance() = default;
  /// From its radiance (mean of the channels) and the square of that.
  EnvironmentIrradiance(const LowHarmonics& radiance, const LowHarmonics& squared)
      : radiance_(radiance), squared_(squared) {}

  struct Arriving {
    double irradiance;  ///< fluence where the receiver has no normal
    /// In [0,1]: 0 if the light comes evenly from all directions, 1 if from a few: the relative variance v of
    /// samples by the cosine, as v / (1 + v).
    double unevenness;
  };
  Arriving at(const Receiver& receiver) const;

  /// Radiance integrated over all directions.
  double total() const { return radiance_.integral(); }

 private:
  LowHarmonics radiance_;
  LowHarmonics squared_;
};

}  // namespace becalm::tracer
