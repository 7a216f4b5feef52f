#pragma once

#include <array>
#include <cstdint>
#include <random>

#include "frame/image.h"
#include "frame/judge/statistical.h"

namespace becalm::judge {

/// How the samples of a pixel are distributed. All have mean 1 and are not negative (gaussian: nearly never).
enum class Noise {
  gaussian,   ///< standard deviation 0.25
  poisson,    ///< one in twenty finds the light, the others nothing
  lognormal,  ///< standard deviation 2.9, skewness 34
  fireflies   ///< lognormal of standard deviation 0.5, and one in 10,000 is 1000 times as bright
};
inline constexpr std::array kNoises{Noise::gaussian, Noise::poisson, Noise::lognormal, Noise::fireflies};
const char* name(Noise noise);

/// Draws the samples of a Monte Carlo pixel.
class SampleSource {
 public:
  SampleSource(Noise noise, std::uint32_t seed) : noise_(noise), engine_(seed) {}
  double next();

 private:
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double normal();

  Noise noise_;
  std::mt19937_64 engine_;
};

/// A rendered image with the variance of its pixels' means.
struct SimulatedImage {
  Image mean;
  Image variance;
  double samples = 0.0;

  Estimate estimate() const { return {mean, &variance, samples}; }
  Estimate without_variance() const { return {mean, nullptr, samples}; }
};

/// One channel; the expectation rises from 0.1 at the left to 10 at the right.
SimulatedImage simulate(SampleSource& source, int edge_px, int samples);

/// The image of a scene whose radiance is `factor` times as bright inside of the square of `edge_px` pixels
/// from (x, y) on.
void brighten(SimulatedImage& image, int x, int y, int edge_px, double factor);

/// Share of frames that fail although they have the reference's expectation.
struct FalseAlarms {
  int runs = 0;
  int with_variance = 0;
  int without_variance = 0;
};
FalseAlarms count_false_alarms(Noise noise, int samples, int reference_samples, int runs, double rate,
                               std::uint32_t seed);

}  // namespace becalm::judge
