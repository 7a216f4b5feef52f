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

}  // namespace

Restorable::Restorable(const NewFrame& frame, const Estimate& estimate)
    : width_(ceil_div(estimate.color.width(), kCell)),
      height_(ceil_div(estimate.color.height(), kCell)),
      cells_(static_cast<std::size_t>(width_) * height_) {
  for_each_in_parallel(height_, [&](int row) {
    for (int column = 0; column < width_; ++column) {
      cells_[static_cast<std::size_t>(row) * width_ + column] = of_cell(frame, estimate, column, row);
    }
  });
  for (int x = 0; x < estimate.color.width(); ++x) columns_.emplace_back(in_cells(x), width_);
}

Allowance Restorable::of_cell(const NewFrame& frame, const Estimate& estimate, int column, int row) {
  const double exposure = frame.exposure;
  const int width = estimate.color.width();
  double residual = 0.0;
  double power = 0.0;
  for (int y = row * kCell; y < std::min((row + 1) * kCell, estimate.color.height()); ++y) {
    for (int x = column * kCell; x < std::min((column + 1) * kCell, width); ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      if (!both_have_data(frame, estimate, i)) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        const double e = exposure * estimate.color.data()[4 * i + c];
        residual += exposure * exposure * residual_square(frame, estimate, i, c);
        power += e * e;
      }
    }
  }
  if (!(residual > 0.0)) return {};
  const double share = residual / (residual + kUnseen * kUnseen * power);
  if (!(power > 0.0)) return {share, kLargestChange, kLargestChange};
  const double change = std::min(std::sqrt(residual / power), kLargestChange);
  return {share, change, std::min(change, residual / power / kLeastOutlier)};
}

}  // namespace becalm::filter
