#include "tracer/sampling/pixel_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "frame/jitter.h"

namespace becalm::tracer {
namespace {

/// The window, scaled to integrate to 1/2 over t in [0,1].
double blackman_harris(double t) {
  return blackman_harris_window(t) / (2.0 * kBlackmanHarrisMean);
}

/// Half of the window, linear between 257 samples: within 3e-5 of its peak.
class HalfWindow {
 public:
  HalfWindow() {
    for (int i = 0; i <= kIntervals; ++i) {
      density_[i] = static_cast<float>(2.0 * blackman_harris(static_cast<double>(i) / kIntervals));
    }
    double sum = 0.0;
    for (int i = 0; i < kIntervals; ++i) {
      cdf_[i] = static_cast<float>(sum);
      sum += 0.5 * (static_cast<double>(density_[i]) + density_[i + 1]) / kIntervals;
    }
    cdf_[kIntervals] = static_cast<float>(sum);
    std::size_t interval = 0;
    for (int k = 0; k < kGuides; ++k) {
      while (cdf_[interval + 1] <= cdf_[kIntervals] * (static_cast<float>(k) / kGuides)) ++interval;
      guide_[k] = static_cast<std::uint8_t>(interval);
    }
  }

  /// Distance in [0,1] at which the integral from the centre reaches u in [0,1].
  float invert(float u) const {
    const float target = std::min(u, 1.0f) * cdf_[kIntervals];
    std::size_t i = guide_[std::min(static_cast<int>(u * kGuides), kGuides - 1)];
    while (i + 1 < kIntervals && cdf_[i + 1] <= target) ++i;
    // Root of density_i x + (density_i+1 - density_i) x^2 / 2 = rest, in the form that does not cancel.
    const float rest = (target - cdf_[i]) * kIntervals;
    const float slope = density_[i + 1] - density_[i];
    const float root = std::sqrt(std::max(0.0f, density_[i] * density_[i] + 2.0f * slope * rest));
    const float x = std::min(2.0f * rest / (density_[i] + root), 1.0f);
    return (static_cast<float>(i) + x) / kIntervals;
  }

 private:
  static constexpr int kIntervals = 256;
  static constexpr int kGuides = 2048;  ///< so many that the search seldom takes a step
  std::array<float, kIntervals + 1> density_;
  std::array<float, kIntervals + 1> cdf_;
  std::array<std::uint8_t, kGuides> guide_;  ///< the interval where u in [k, k+1) / kGuides starts
};

const HalfWindow& blackman_harris_half() {
  static const HalfWindow half;
  return half;
}

/// Offset in [-1,1] for u in [0,1], monotone.
float sample_unit(FilterShape type, float u) {
  const float centred = 2.0f * u - 1.0f;  // the half, and how much of it lies nearer to the centre
  switch (type) {
    case FilterShape::box:
      return centred;
    case FilterShape::tent: {
      const float rest = 1.0f - std::abs(centred);
      return std::copysign(1.0f - std::sqrt(rest), centred);
    }
    case FilterShape::blackman_harris:
      return std::copysign(blackman_harris_half().invert(std::abs(centred)), centred);
  }
  return 0.0f;
}

}  // namespace

V2f sample(const PixelFilter& filter, const V2f& u) {
  return V2f(sample_unit(filter.type, u.x), sample_unit(filter.type, u.y)) * filter.radius_px;
}

}  // namespace becalm::tracer
