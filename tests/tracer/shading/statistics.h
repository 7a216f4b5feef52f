#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Uniform numbers in [0,1) that are the same on every machine (the standard fixes mt19937, not its
/// distributions).
class TestRandom {
 public:
  explicit TestRandom(std::uint32_t seed) : engine_(seed) {}
  float next() { return static_cast<float>(engine_() >> 8) * 0x1p-24f; }
  V2f next_2d() {
    const float x = next();
    return {x, next()};
  }

 private:
  std::mt19937 engine_;
};

/// Probability that a chi-square variable with this many degrees of freedom exceeds `statistic`.
double chi_square_p_value(double statistic, int degrees_of_freedom);

/// Level of each of `tests` independent tests so that one fails by chance in the whole suite with probability
/// `suite_level` (Sidak).
double sidak_level(double suite_level, int tests);

/// Pearson's test of counts against expectations; cells that expect fewer than 5 are pooled.
struct ChiSquare {
  double p_value;
  double statistic;
  int degrees_of_freedom;
};
ChiSquare chi_square(const std::vector<double>& observed, const std::vector<double>& expected);

/// A rectangle of a sampler's domain.
struct Cell {
  double x0, x1, y0, y1;
  double area() const { return (x1 - x0) * (y1 - y0); }
};

/// A sampler and its density on a rectangle. Samplers on the sphere are charted by (phi, theta); see
/// sphere_chart.
struct Chart {
  Cell domain;
  std::function<std::optional<V2d>(TestRandom&)> draw;  ///< nothing: the sampler found nothing
  std::function<double(const V2d&)> density;            ///< per unit of the domain's area
  /// Borders across which the density may jump: no cell crosses them.
  std::vector<double> jumps_x;
  std::vector<double> jumps_y;
};

/// The chart (phi in [-pi, pi], theta in [0, pi] from +z) of a sampler of directions with a density per solid
/// angle.
Chart sphere_chart(std::function<std::optional<V3f>(TestRandom&)> draw, std::function<float(const V3f&)> pdf);

/// Integral over the cell by adaptive Gauss-Legendre quadrature.
double integrate(const std::function<double(const V2d&)>& function, const Cell& cell,
                 double relative_tolerance = 1e-4);

/// Draws `samples` and tests them against the density: the domain is cut into cells that hold equal shares of
/// a pilot run, so that narrow lobes are resolved where they are, and the density is integrated over each;
/// samples that found nothing are a cell that expects 1 - the whole integral. The message replays a failure.
struct SamplerTest {
  ChiSquare result;
  double integral;  ///< of the density over the domain
  std::string replay;
};
SamplerTest test_sampler(const Chart& chart, std::uint32_t seed, int samples = 100000, int cells = 256);

}  // namespace becalm::tracer
