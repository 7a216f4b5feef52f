#include "frame/judge/block_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace becalm::judge {
namespace {

/// Without the test's variance a pixel counts as brighter by at most so many standard deviations: one bright
/// sample cannot decide a block.
constexpr double kLargestBrightening = 3.0;
/// Skewness beyond which normal_score would fall no further.
constexpr double kLargestSkewness = 6.0;
/// Differences below the root of the smallest float have no variance in a file of floats.
constexpr double kSmallestDifference = 0x1p-74;

/// Wilson and Hilferty 1931: a gamma variable's cube root is nearly normal. `z` >= 0 is in standard
/// deviations.
double normal_score(double z, double skewness) {
  if (skewness < 1e-3) return z;
  return 6.0 / skewness * (std::cbrt(1.0 + 0.5 * skewness * z) - 1.0 + skewness * skewness / 36.0);
}

/// Not less than a file of halves can tell, unless the mean's own rounding is larger.
double stored_variance(const Estimate& estimate, double rounding, int x, int y, int c) {
  const double stored = variance_at(*estimate.variance, x, y, c);
  const double mean_rounding = rounding * std::abs(estimate.mean.at(x, y, c));
  const bool is_hidden = mean_rounding >= std::sqrt(estimate.variance_rounding);
  return is_hidden ? stored : std::max(stored, estimate.variance_rounding);
}

}  // namespace

Sums Cells::block(int x, int y) const {
  Sums total;
  for (int v = y; v < std::min(y + 2, rows); ++v) {
    for (int u = x; u < std::min(x + 2, columns); ++u) total += at(u, v);
  }
  return total;
}

Cells merged(const Cells& cells) {
  Cells next{.edge_px = 2 * cells.edge_px,
             .columns = (cells.columns + 1) / 2,
             .rows = (cells.rows + 1) / 2,
             .sums = {}};
  next.sums.resize(static_cast<std::size_t>(next.columns) * next.rows);
  for (int y = 0; y < next.rows; ++y) {
    for (int x = 0; x < next.columns; ++x) next.at(x, y) = cells.block(2 * x, 2 * y);
  }
  return next;
}

double variance_at(const Image& image, int x, int y, int c) {
  return std::max(0.0, double(image.at(x, y, c)));
}

/// The variance of a sample is estimated from the samples of both images together: a pixel whose few samples
/// missed a bright event, or alone have one, then has a variance that knows of it. The third moment is that
/// of a gamma distribution, which has the skewness of non-negative samples: 2 sigma / mean.
Sums sums_of(const Estimate& test, const Estimate& reference, double rounding, int x, int y, int c) {
  const double n = test.samples;
  const double m = reference.samples;
  const double value = test.mean.at(x, y, c);
  const double expected = reference.mean.at(x, y, c);
  const double variance_m = stored_variance(reference, rounding, x, y, c);
  const double variance_n =
      test.variance != nullptr ? stored_variance(test, rounding, x, y, c) : variance_m * m / n;
  Sums sums;
  sums.darker = sums.brighter = value - expected;
  sums.rounding = rounding * (std::abs(value) + std::abs(expected)) + test.rounding + reference.rounding +
                  kSmallestDifference;
  sums.shown_variance = variance_n + variance_m;
  // Without the test's variance a black pixel may be one whose samples all missed what the test's samples
  // hit.
  const bool may_vary = variance_m > 0.0 || (test.variance != nullptr ? variance_n > 0.0 : expected == 0.0);
  if (!may_vary) return sums;
  const double squares =
      (m - 1.0) * m * variance_m + (n - 1.0) * n * variance_n + sums.darker * sums.darker * n * m / (n + m);
  const double of_sample = squares / (n + m - 1.0);
  // Non-negative samples have no smaller mean.
  const double mean = std::max((n * value + m * expected) / (n + m), std::sqrt(of_sample / (n + m)));
  sums.variance = of_sample * (1.0 / n + 1.0 / m);
  if (of_sample > 0.0)
    sums.third = 2.0 * of_sample * of_sample / mean * std::max(0.0, 1.0 / (n * n) - 1.0 / (m * m));
  if (test.variance == nullptr) {
    sums.brighter = std::min(sums.brighter, kLargestBrightening * std::sqrt(sums.variance));
  }
  return sums;
}

/// The lower tail of a sum of non-negative samples is lighter than the normal distribution's, which stands
/// for it.
double z_of(const Sums& sums, double noise_factor) {
  const double brighter = std::max(0.0, sums.brighter - sums.rounding);
  const double darker = std::max(0.0, -sums.darker - sums.rounding);
  if (brighter == 0.0 && darker == 0.0) return 0.0;
  const double variance = std::max({sums.variance * noise_factor, sums.shown_variance, sums.local_variance});
  if (darker > 0.0) return -darker / std::sqrt(variance);
  if (variance == 0.0) return std::numeric_limits<double>::infinity();
  const double skewness = std::min(kLargestSkewness, sums.third / (variance * std::sqrt(variance)));
  return std::max(0.0, normal_score(brighter / std::sqrt(variance), skewness));
}

}  // namespace becalm::judge
