#include "filter/smooth/restorable.h"

#include <cmath>

#include "filter/ceil_div.h"
#include "filter/for_rows.h"

namespace becalm::filter {
namespace {

/// Relative brightness, above that around them, of samples that smoothing removes.
constexpr double kLeastOutlier = 0.25;
/// Limit of the relative change of a pixel at one time.
constexpr double kLargestChange = 1.0;

/// Sums of squares over pixels and channels.
struct Squares {
  Squares& operator+=(const Squares& other) {
    residual += other.residual;
    power += other.power;
    return *this;
  }
  /// The part of the pixels that smoothing may have changed, in [0,1].
  double share() const { return residual > 0.0 ? residual / (residual + kUnseen * kUnseen * power) : 0.0; }

  double residual = 0.0;  ///< of the difference between the frame and the estimate
  double power = 0.0;     ///< of the estimate
};

/// Of one pixel, exposed; zeros without data.
Squares squares_of(const NewFrame& frame, const Estimate& estimate, std::size_t i) {
  Squares squares;
  if (!both_have_data(frame, estimate, i)) return squares;
  const double exposure = frame.exposure;
  for (std::size_t c = 0; c < 3; ++c) {
    const double e = exposure * estimate.color.data()[4 * i + c];
    squares += {exposure * exposure * residual_square(frame, estimate, i, c), e * e};
  }
  return squares;
}

}  // namespace

Restorable::Restorable(const NewFrame& frame, const Estimate& estimate)
    : width_(ceil_div(estimate.color.width(), kCell)),
      height_(ceil_div(estimate.color.height(), kCell)),
      cells_(static_cast<std::size_t>(width_) * height_),
      share_of_pixel_(static_cast<std::size_t>(estimate.color.width()) * estimate.color.height()) {
  for_each_in_parallel(height_, [&](int row) {
    for (int column = 0; column < width_; ++column) {
      cells_[static_cast<std::size_t>(row) * width_ + column] = of_cell(frame, estimate, column, row);
    }
  });
  for_rows(estimate.color.height(), [&](int begin, int end) {
    for (int y = begin; y < end; ++y) find_shares_of_row(frame, estimate, y);
  });
  for (int x = 0; x < estimate.color.width(); ++x) columns_.emplace_back(in_cells(x), width_);
}

Allowance Restorable::of_cell(const NewFrame& frame, const Estimate& estimate, int column, int row) {
  const int width = estimate.color.width();
  Squares sum;
  for (int y = row * kCell; y < std::min((row + 1) * kCell, estimate.color.height()); ++y) {
    for (int x = column * kCell; x < std::min((column + 1) * kCell, width); ++x) {
      sum += squares_of(frame, estimate, static_cast<std::size_t>(y) * width + x);
    }
  }
  if (!(sum.residual > 0.0)) return {};
  if (!(sum.power > 0.0)) return {sum.share(), 1.0, kLargestChange, kLargestChange};
  const double change = std::min(std::sqrt(sum.residual / sum.power), kLargestChange);
  return {sum.share(), 1.0, change, std::min(change, sum.residual / sum.power / kLeastOutlier)};
}

void Restorable::find_shares_of_row(const NewFrame& frame, const Estimate& estimate, int y) {
  const int width = estimate.color.width();
  // Of three rows, with a column without data before the first and after the last.
  std::vector<Squares> of_columns(static_cast<std::size_t>(width) + 2);
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, estimate.color.height() - 1); ++v) {
    for (int x = 0; x < width; ++x) {
      of_columns[x + 1] += squares_of(frame, estimate, static_cast<std::size_t>(v) * width + x);
    }
  }
  for (int x = 0; x < width; ++x) {
    Squares sum = of_columns[x];
    sum += of_columns[x + 1];
    sum += of_columns[x + 2];
    share_of_pixel_[static_cast<std::size_t>(y) * width + x] = static_cast<float>(sum.share());
  }
}

}  // namespace becalm::filter
