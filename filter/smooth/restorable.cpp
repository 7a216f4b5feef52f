#include "filter/smooth/restorable.h"

#include <cmath>
#include <span>

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

/// Squares of the pixels of some rows, each computed once.
class RowsOfSquares {
 public:
  RowsOfSquares(const NewFrame& frame, const Estimate& estimate, int first, int end)
      : width_(static_cast<std::size_t>(estimate.color.width())), first_(first), end_(end) {
    squares_.reserve(width_ * static_cast<std::size_t>(end - first));
    for (std::size_t i = width_ * first; i < width_ * end; ++i)
      squares_.push_back(squares_of(frame, estimate, i));
  }
  int first() const { return first_; }
  int end() const { return end_; }
  std::span<const Squares> row(int y) const {
    return std::span(squares_).subspan(width_ * static_cast<std::size_t>(y - first_), width_);
  }

 private:
  std::size_t width_;
  int first_;
  int end_;
  std::vector<Squares> squares_;
};

/// Of a cell of these rows and columns.
Allowance of_cell(const RowsOfSquares& squares, int first_row, int end_row, int first_column,
                  int end_column) {
  Squares sum;
  for (int y = first_row; y < end_row; ++y) {
    const std::span<const Squares> row = squares.row(y);
    for (int x = first_column; x < end_column; ++x) sum += row[x];
  }
  if (!(sum.residual > 0.0)) return {};
  if (!(sum.power > 0.0)) return {sum.share(), 1.0, kLargestChange, kLargestChange};
  const double change = std::min(std::sqrt(sum.residual / sum.power), kLargestChange);
  return {sum.share(), 1.0, change, std::min(change, sum.residual / sum.power / kLeastOutlier)};
}

/// The shares of the 3x3 pixels around each pixel of a row.
void find_shares(const RowsOfSquares& squares, int y, std::span<float> shares) {
  // Of three rows, with a column without data before the first and after the last.
  std::vector<Squares> of_columns(shares.size() + 2);
  for (int v = std::max(y - 1, squares.first()); v <= std::min(y + 1, squares.end() - 1); ++v) {
    const std::span<const Squares> row = squares.row(v);
    for (std::size_t x = 0; x < row.size(); ++x) of_columns[x + 1] += row[x];
  }
  for (std::size_t x = 0; x < shares.size(); ++x) {
    Squares sum = of_columns[x];
    sum += of_columns[x + 1];
    sum += of_columns[x + 2];
    shares[x] = static_cast<float>(sum.share());
  }
}

/// Without negative values and NaN.
double brightness(const float* rgb) {
  const auto light = [&](std::size_t c) { return std::max(0.0, double(rgb[c])); };
  return (light(0) + light(1) + light(2)) / 3.0;
}

}  // namespace

Restorable::Restorable(const NewFrame& frame, const Estimate& estimate)
    : width_(ceil_div(estimate.color.width(), kCell)),
      height_(ceil_div(estimate.color.height(), kCell)),
      cells_(static_cast<std::size_t>(width_) * height_),
      share_of_pixel_(static_cast<std::size_t>(estimate.color.width()) * estimate.color.height()) {
  const int rows = estimate.color.height();
  const int columns = estimate.color.width();
  for_each_in_parallel(height_, [&](int row) {
    const int first = row * kCell;
    const int end = std::min(first + kCell, rows);
    const RowsOfSquares squares(frame, estimate, std::max(first - 1, 0), std::min(end + 1, rows));
    for (int x = 0; x < width_; ++x) {
      cells_[static_cast<std::size_t>(row) * width_ + x] =
          of_cell(squares, first, end, x * kCell, std::min((x + 1) * kCell, columns));
    }
    for (int y = first; y < end; ++y) {
      const std::size_t begin = static_cast<std::size_t>(y) * columns;
      find_shares(squares, y, std::span(share_of_pixel_).subspan(begin, columns));
    }
  });
  for (int x = 0; x < columns; ++x) columns_.emplace_back(in_cells(x), width_);
  mean_brightness_ = mean_of_noisy(frame, estimate);
}

std::vector<double> Restorable::weights(std::span<const float> rgba) const {
  std::vector<double> weights(rgba.size() / 4, 1.0);
  if (!(mean_brightness_ > 0.0)) return weights;
  const double scale = 1.0 / mean_brightness_;
  for (std::size_t x = 0; x < weights.size(); ++x) {
    const double root = std::sqrt(std::min(scale * brightness(&rgba[4 * x]), kBrightest));
    weights[x] = root * std::sqrt(root);
  }
  return weights;
}

double Restorable::mean_of_noisy(const NewFrame& frame, const Estimate& estimate) const {
  struct Sum {
    double light = 0.0;
    double share = 0.0;
  };
  const std::size_t width = columns_.size();
  std::vector<Sum> rows(share_of_pixel_.size() / width);
  for_each_in_parallel(static_cast<int>(rows.size()), [&](int y) {
    Sum& row = rows[static_cast<std::size_t>(y)];
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      if (!both_have_data(frame, estimate, i)) continue;
      row.light += share_of_pixel_[i] * brightness(&estimate.color.data()[4 * i]);
      row.share += share_of_pixel_[i];
    }
  });
  Sum sum;
  for (const Sum& row : rows) {
    sum.light += row.light;
    sum.share += row.share;
  }
  return sum.share > 0.0 ? sum.light / sum.share : 0.0;
}

}  // namespace becalm::filter
