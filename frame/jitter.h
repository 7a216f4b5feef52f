#pragma once

#include <Imath/ImathVec.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace becalm {

/// The separable filters that pixels are averages by.
enum class FilterShape { blackman_harris, box, tent };

/// The mean of blackman_harris_window.
inline constexpr double kBlackmanHarrisMean = 0.35875;

/// The 4-term Blackman-Harris window at distance t in [0,1] of the centre, where it is 1. Source: Harris, "On
/// the Use of Windows for Harmonic Analysis", 1978: the constant term is the mean.
inline double blackman_harris_window(double t) {
  const double phase = std::numbers::pi * t;
  return kBlackmanHarrisMean + 0.48829 * std::cos(phase) + 0.14128 * std::cos(2.0 * phase) +
         0.01168 * std::cos(3.0 * phase);
}

/// The positions of a frame's samples within their pixels, if they are the same in all pixels, as temporal
/// antialiasing needs them. Samples have equal weights; over many frames, the filter is the density of their
/// positions.
struct FrameJitter {
  std::vector<Imath::V2f> positions_px;  ///< from the pixel's centre, +x right, +y down; one a sample
  FilterShape filter = FilterShape::blackman_harris;
  float radius_px = 1.5f;  ///< of the filter, along each axis

  bool operator==(const FrameJitter&) const = default;
};

}  // namespace becalm
