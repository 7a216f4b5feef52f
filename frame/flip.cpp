#include "frame/flip.h"

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "frame/compared_pixels.h"

// Names in quotes are steps of the paper's algorithm (its color pipeline, feature pipeline and their union).

namespace becalm {
namespace {

using Imath::V2d;
using Imath::V3d;

/// Linear sRGB to XYZ under D65, as a matrix for row vectors, with the digits of the authors' code.
const Imath::M33d kRgbToXyz(10135552.0 / 24577794.0, 2613072.0 / 12288897.0, 1425312.0 / 73733382.0,  //
                            8788810.0 / 24577794.0, 8788810.0 / 12288897.0, 8788810.0 / 73733382.0,   //
                            4435075.0 / 24577794.0, 887015.0 / 12288897.0, 70074185.0 / 73733382.0);
const Imath::M33d kXyzToRgb = kRgbToXyz.inverse();
const V3d kWhite = V3d(1.0) * kRgbToXyz;

V3d clamped(const V3d& rgb) {
  return {std::clamp(rgb.x, 0.0, 1.0), std::clamp(rgb.y, 0.0, 1.0), std::clamp(rgb.z, 0.0, 1.0)};
}

/// YCxCz without its offset and scales, which cancel: what is filtered is turned back to XYZ, and the
/// features use (Y + 16) / 116, which is this y. x: achromatic, y: red-green, z: blue-yellow.
V3d opponent_of(const V3d& rgb) {
  const V3d xyz = rgb * kRgbToXyz / kWhite;
  return {xyz.y, xyz.x - xyz.y, xyz.y - xyz.z};
}

V3d rgb_of(const V3d& opponent) {
  const V3d xyz(opponent.x + opponent.y, opponent.x, opponent.x - opponent.z);
  return xyz * kWhite * kXyzToRgb;
}

/// L*a*b* with "Hunt" adjustment: colours of dark pixels differ less to the eye.
V3d hunt_lab(const V3d& rgb) {
  const auto compress = [](double t) {
    constexpr double delta = 6.0 / 29.0;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3.0 * delta * delta) + 4.0 / 29.0;
  };
  const V3d xyz = rgb * kRgbToXyz / kWhite;
  const double y = compress(xyz.y);
  const double lightness = 116.0 * y - 16.0;
  return {lightness, 0.01 * lightness * 500.0 * (compress(xyz.x) - y),
          0.01 * lightness * 200.0 * (y - compress(xyz.z))};
}

/// The "HyAB" distance to the power of 0.7.
double color_distance(const V3d& lab_a, const V3d& lab_b) {
  const V3d d = lab_a - lab_b;
  return std::pow(std::abs(d.x) + V2d(d.y, d.z).length(), 0.7);
}

/// "Redistribution of errors": the lowest 40 % of the distances take the range to 0.95. The largest distance
/// of two colours is that of green and blue.
double color_difference(const V3d& lab_a, const V3d& lab_b) {
  static const double largest = color_distance(hunt_lab({0.0, 1.0, 0.0}), hunt_lab({0.0, 0.0, 1.0}));
  const double knee = 0.4 * largest;
  const double distance = color_distance(lab_a, lab_b);
  if (distance < knee) return 0.95 * distance / knee;
  return 0.95 + 0.05 * (distance - knee) / (largest - knee);
}

/// The weights at one distance along a row or a column. All kernels of the paper are products of these, or
/// (blue-yellow) a sum of two products.
struct Tap {
  double achromatic;
  double red_green;
  double blue_yellow_wide;
  double blue_yellow_narrow;
  double smooth;     ///< Gaussian of the feature detectors,
  double slope;      ///< its first derivative,
  double curvature;  ///< and its second one
};

struct Kernels {
  explicit Kernels(double pixels_per_degree);

  int radius;
  std::vector<Tap> taps;  ///< from -radius to radius
  double wide_share;      ///< of the blue-yellow kernel
};

/// Scales the values of the taps so that those of each sign add up to 1 or -1.
void normalise(std::vector<Tap>& taps, double Tap::*value) {
  double positive = 0.0;
  double negative = 0.0;
  for (const Tap& tap : taps) (tap.*value > 0.0 ? positive : negative) += std::abs(tap.*value);
  for (Tap& tap : taps) {
    if (tap.*value != 0.0) tap.*value /= tap.*value > 0.0 ? positive : negative;
  }
}

/// "Spatial filtering": the contrast sensitivity functions, which are sums of Gaussians
/// a sqrt(pi/b) exp(-pi^2 x^2 / b) with the paper's constants. "Feature detection": derivatives of a Gaussian
/// whose width is that of the eye's edge detectors, 0.082 degrees.
Kernels::Kernels(double pixels_per_degree) {
  constexpr double pi = std::numbers::pi;
  constexpr double wide_a = 34.1;
  constexpr double wide_b = 0.04;
  constexpr double narrow_a = 13.5;
  constexpr double narrow_b = 0.025;
  const double sigma = 0.5 * 0.082 * pixels_per_degree;
  const int filter_radius =
      static_cast<int>(std::ceil(3.0 * std::sqrt(wide_b / (2.0 * pi * pi)) * pixels_per_degree));
  const int feature_radius = static_cast<int>(std::ceil(3.0 * sigma));
  radius = std::max(filter_radius, feature_radius);
  double wide_sum = 0.0;
  double narrow_sum = 0.0;
  for (int x = -radius; x <= radius; ++x) {
    Tap& tap = taps.emplace_back();
    if (std::abs(x) <= filter_radius) {
      const double degrees = x / pixels_per_degree;
      const auto gaussian = [&](double b) { return std::exp(-pi * pi * degrees * degrees / b); };
      tap.achromatic = gaussian(0.0047);
      tap.red_green = gaussian(0.0053);
      wide_sum += tap.blue_yellow_wide = gaussian(wide_b);
      narrow_sum += tap.blue_yellow_narrow = gaussian(narrow_b);
    }
    if (std::abs(x) <= feature_radius) {
      const double share = x / sigma;
      tap.smooth = std::exp(-0.5 * share * share);
      tap.slope = -share * tap.smooth;
      tap.curvature = (share * share - 1.0) * tap.smooth;
    }
  }
  for (double Tap::*value : {&Tap::achromatic, &Tap::red_green, &Tap::blue_yellow_wide,
                             &Tap::blue_yellow_narrow, &Tap::smooth, &Tap::slope, &Tap::curvature}) {
    normalise(taps, value);
  }
  const double wide = wide_a * std::sqrt(pi / wide_b) * wide_sum * wide_sum;
  const double narrow = narrow_a * std::sqrt(pi / narrow_b) * narrow_sum * narrow_sum;
  wide_share = wide / (wide + narrow);
}

/// What the metric compares of a pixel.
struct Seen {
  V3d lab;
  double edge;
  double point;
};

/// The rows of one image that reach a pixel's window, convolved along the row; beyond the border the image
/// repeats its last pixels.
class WindowRows {
 public:
  WindowRows(const Kernels& kernels, int width)
      : kernels_(kernels), rows_(kernels.taps.size(), std::vector<Tap>(width)) {}

  /// `opponent` is row y with `radius` pixels more on either side. Rows come in ascending order.
  void fill(int y, const std::vector<V3d>& opponent) {
    std::vector<Tap>& row = rows_[y % rows_.size()];
    for (std::size_t x = 0; x < row.size(); ++x) {
      Tap sum{};
      for (std::size_t i = 0; i < kernels_.taps.size(); ++i) {
        const Tap& tap = kernels_.taps[i];
        const V3d& value = opponent[x + i];
        sum.achromatic += tap.achromatic * value.x;
        sum.red_green += tap.red_green * value.y;
        sum.blue_yellow_wide += tap.blue_yellow_wide * value.z;
        sum.blue_yellow_narrow += tap.blue_yellow_narrow * value.z;
        sum.smooth += tap.smooth * value.x;
        sum.slope += tap.slope * value.x;
        sum.curvature += tap.curvature * value.x;
      }
      row[x] = sum;
    }
  }

  /// The rows from y - radius to y + radius that there are must be the last that were filled.
  Seen look(int x, int y, int height) const {
    Tap colour{};
    V2d edge(0.0);
    V2d point(0.0);
    for (std::size_t i = 0; i < kernels_.taps.size(); ++i) {
      const Tap& tap = kernels_.taps[i];
      const int from = std::clamp(y - kernels_.radius + static_cast<int>(i), 0, height - 1);
      const Tap& value = rows_[from % rows_.size()][x];
      colour.achromatic += tap.achromatic * value.achromatic;
      colour.red_green += tap.red_green * value.red_green;
      colour.blue_yellow_wide += tap.blue_yellow_wide * value.blue_yellow_wide;
      colour.blue_yellow_narrow += tap.blue_yellow_narrow * value.blue_yellow_narrow;
      edge += V2d(tap.smooth * value.slope, tap.slope * value.smooth);
      point += V2d(tap.smooth * value.curvature, tap.curvature * value.smooth);
    }
    const double blue_yellow =
        std::lerp(colour.blue_yellow_narrow, colour.blue_yellow_wide, kernels_.wide_share);
    return {.lab = hunt_lab(clamped(rgb_of({colour.achromatic, colour.red_green, blue_yellow}))),
            .edge = edge.length(),
            .point = point.length()};
  }

 private:
  const Kernels& kernels_;
  std::vector<std::vector<Tap>> rows_;  ///< row y is in slot y % size
};

/// "Feature metric" and "Final difference": a feature that only one of the images has raises the colour
/// difference.
double difference(const Seen& a, const Seen& b) {
  const double feature = std::max(std::abs(a.edge - b.edge), std::abs(a.point - b.point));
  return std::pow(color_difference(a.lab, b.lab), 1.0 - std::sqrt(feature / std::numbers::sqrt2));
}

/// The display image's pixel.
V3d display_opponent(const Image& image, int x, int y) {
  const std::span<const float> pixel = image.pixel(x, y);
  if (pixel.size() < 3) return opponent_of(clamped(V3d(pixel[0])));
  return opponent_of(clamped({pixel[0], pixel[1], pixel[2]}));
}

}  // namespace

Measured flip(const Image& test, const Image& reference, double pixels_per_degree) {
  require_comparable(std::array{&test, &reference});
  const int width = test.width();
  const int height = test.height();
  const int channels = compared_channels(test);
  const Kernels kernels(pixels_per_degree);
  WindowRows test_rows(kernels, width);
  WindowRows reference_rows(kernels, width);
  std::vector<V3d> test_row(width + 2 * kernels.radius);
  std::vector<V3d> reference_row(test_row.size());
  const auto fill = [&](int y) {
    for (std::size_t i = 0; i < test_row.size(); ++i) {
      const int x = std::clamp(static_cast<int>(i) - kernels.radius, 0, width - 1);
      const bool reference_finite = all_finite(std::array{&reference}, x, y, channels);
      reference_row[i] = reference_finite ? display_opponent(reference, x, y) : V3d(0.0);
      test_row[i] = reference_finite && all_finite(std::array{&test}, x, y, channels)
                        ? display_opponent(test, x, y)
                        : reference_row[i];
    }
    test_rows.fill(y, test_row);
    reference_rows.fill(y, reference_row);
  };

  Measured result;
  double total = 0.0;
  std::size_t count = 0;
  int filled = 0;
  for (int y = 0; y < height; ++y) {
    for (; filled < std::min(height, y + kernels.radius + 1); ++filled) fill(filled);
    double row_total = 0.0;
    for (int x = 0; x < width; ++x) {
      if (!all_finite(std::array{&test, &reference}, x, y, channels)) {
        ++result.skipped;
        continue;
      }
      row_total += difference(test_rows.look(x, y, height), reference_rows.look(x, y, height));
      ++count;
    }
    total += row_total;
  }
  result.value = count > 0 ? total / static_cast<double>(count) : kNothingMeasured;
  return result;
}

}  // namespace becalm
