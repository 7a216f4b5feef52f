#pragma once

#include <cmath>

#include "tests/tracer/shading/statistics.h"

namespace becalm::tracer {

/// A Monte Carlo mean and its standard error.
struct Estimate {
  double mean;
  double error;
};

/// Of value(random) over independent draws.
template <class F>
Estimate estimate(std::uint32_t seed, int samples, const F& value) {
  TestRandom random(seed);
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < samples; ++i) {
    const double x = value(random);
    sum += x;
    squares += x * x;
  }
  const double mean = sum / samples;
  return {mean, std::sqrt(std::max(0.0, squares / samples - mean * mean) / samples)};
}

/// The part of the irradiance that the light sample gives a surface with this unit normal.
template <class Sample>
double irradiance(const Sample& drawn, const V3f& normal) {
  return drawn ? drawn->radiance.x * std::max(0.0f, normal.dot(drawn->dir_world)) / drawn->pdf_solid_angle
               : 0.0;
}

}  // namespace becalm::tracer
