#pragma once

#include <vector>

#include "frame/judge/statistical.h"

namespace becalm::judge {

/// What a block's pixels add up to, of one channel.
struct Sums {
  double brighter = 0.0;  ///< test - reference, each pixel's limited where the test has no variance
  double darker = 0.0;    ///< test - reference
  double rounding = 0.0;  ///< what of the difference rounding may cause
  double variance = 0.0;  ///< of the difference, from the samples of both images as if they were one set
  double third = 0.0;     ///< third central moment of the difference
  double shown_variance = 0.0;  ///< of the difference, as both images tell it
  double local_variance = 0.0;  ///< mean of that over the pixel and its neighbours

  Sums& operator+=(const Sums& other) {
    brighter += other.brighter;
    darker += other.darker;
    rounding += other.rounding;
    variance += other.variance;
    third += other.third;
    shown_variance += other.shown_variance;
    local_variance += other.local_variance;
    return *this;
  }
};

/// A grid of square cells of the image, and their sums.
struct Cells {
  int edge_px = 1;
  int columns = 0;
  int rows = 0;
  std::vector<Sums> sums;

  Sums& at(int x, int y) { return sums[static_cast<std::size_t>(y) * columns + x]; }
  const Sums& at(int x, int y) const { return sums[static_cast<std::size_t>(y) * columns + x]; }
  /// Of the (at most) 2x2 cells from (x, y) on.
  Sums block(int x, int y) const;
};

/// Cells of twice the edge.
Cells merged(const Cells& cells);

double variance_at(const Image& image, int x, int y, int c);

/// One channel of one pixel. `rounding` is that of StatisticalOptions.
Sums sums_of(const Estimate& test, const Estimate& reference, double rounding, int x, int y, int c);

/// The difference in standard deviations, corrected for skewness so that it compares with the normal
/// distribution; infinite where nothing varies. `noise_factor`: how much more the test varies than the
/// reference says.
double z_of(const Sums& sums, double noise_factor);

}  // namespace becalm::judge
