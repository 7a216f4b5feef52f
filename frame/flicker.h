#pragma once

#include <vector>

#include "frame/metrics.h"

namespace becalm {

/// How much the error of a sequence changes over time: mean over pixels and channels of Var_t(x - r) over
/// mean_t(r^2) + 0.01. An error that stands still, such as blur, does not count; noise and boiling do. With
/// two independent references a, b the variance is the covariance of x - a and x - b, which the references'
/// own noise does not add to; one reference is given as both. Pixels that are not finite in a frame are
/// skipped in all frames.
class Flicker {
 public:
  /// Frames of one size, in any order. Throws std::invalid_argument as the metrics do.
  void add(const Image& test, const Image& reference_a, const Image& reference_b);

  /// NaN for fewer than two frames.
  Measured measured() const;

 private:
  /// Sums over the frames for one channel of one pixel.
  struct Sums {
    double error_a = 0.0, error_b = 0.0, product = 0.0, reference_squared = 0.0;
  };
  int frames_ = 0;
  int width_ = 0, height_ = 0, channels_ = 0;  ///< of all frames
  std::vector<Sums> sums_;
  std::vector<bool> skipped_;  ///< by pixel
};

}  // namespace becalm
