#include "tests/filter/reference/smooth.h"

#include <limits>
#include <utility>

namespace becalm::reference {
namespace {

constexpr std::size_t kFeatures = std::tuple_size_v<SmoothFeatures>;
constexpr std::size_t kUnknowns = kFeatures + 1;  // the slopes, then the value at the pixel
using Vector = std::array<double, kUnknowns>;
using Matrix = std::array<Vector, kUnknowns>;

/// What patches are compared by.
struct Guide {
  double luminance = 0.0;
  double variance = 0.0;
};

double divisor(const SmoothFeatures& features, std::size_t c) {
  return std::max(features[c], 0.04);
}

/// Mean of the squared scales by which radiance without albedo turns into the colour's channels.
double mean_square(const SmoothFeatures& features, double exposure) {
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) sum += std::pow(divisor(features, c) / exposure, 2) / 3;
  return sum;
}

double patch_distance(const Grid<Guide>& guide, int x, int y, int i, int j,
                      const filter::Settings& settings) {
  const int radius = settings.smooth_patch_radius;
  const int pixels = (2 * radius + 1) * (2 * radius + 1);
  const double strength = settings.smooth_strength;
  double sum = 0;
  for (int v = -radius; v <= radius; ++v) {
    for (int u = -radius; u <= radius; ++u) {
      const Guide& a = guide.clamped(x + u, y + v);
      const Guide& b = guide.clamped(x + u + i, y + v + j);
      const double level = 0.5 * (a.luminance + b.luminance);
      const double unexplained =
          std::pow(a.luminance - b.luminance, 2) - (a.variance + std::min(a.variance, b.variance));
      const double allowed = a.variance + std::min(b.variance, 10 * a.variance);
      const double distance = unexplained / (strength * strength * allowed + 3e-3 * (level * level + 1e-3));
      const bool may_be_noise = std::abs(a.luminance - b.luminance) < 32;
      sum += may_be_noise ? std::min(distance, std::max(4.0 * pixels, distance / 8)) : distance;
    }
  }
  return sum / pixels;
}

/// Squared differences of normal, albedo and packed depth.
std::array<double, 3> squared_differences(const SmoothFeatures& a, const SmoothFeatures& b) {
  const auto squares = [&](std::size_t first, std::size_t count) {
    double sum = 0;
    for (std::size_t f = first; f < first + count; ++f) sum += std::pow(a[f] - b[f], 2);
    return sum;
  };
  return {squares(4, 3), squares(0, 3), squares(3, 1)};
}

double surface_weight(const Grid<SmoothFeatures>& features, int x, int y, int i, int j,
                      const filter::Settings& settings) {
  // To the pixel at a shift, or beyond the border to the opposite one.
  const auto step = [&](int u, int v) {
    const bool inside = x + u >= 0 && x + u < features.width && y + v >= 0 && y + v < features.height;
    const int side = inside ? 1 : -1;
    return squared_differences(features.clamped(x + side * u, y + side * v), features.at(x, y));
  };
  const std::array<double, 3> differences = squared_differences(features.at(x + i, y + j), features.at(x, y));
  constexpr std::array<double, 3> kFalloff{1, 2, 1000};
  double distance = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double slope =
        std::max(std::min(step(-1, 0)[k], step(1, 0)[k]), std::min(step(0, -1)[k], step(0, 1)[k]));
    const double falloff = settings.smooth_surfaces * kFalloff[k];
    distance += falloff / (1 + 10 * falloff * slope) * differences[k];
  }
  constexpr double kLeast = 1.0 / 512;
  return std::max(std::exp(-distance) - kLeast, 0.0) / (1 - kLeast);
}

/// Gauss-Jordan elimination with partial pivoting.
Vector solve(Matrix m, Vector right) {
  for (std::size_t column = 0; column < kUnknowns; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column; row < kUnknowns; ++row) {
      if (std::abs(m[row][column]) > std::abs(m[pivot][column])) pivot = row;
    }
    std::swap(m[column], m[pivot]);
    std::swap(right[column], right[pivot]);
    for (std::size_t row = 0; row < kUnknowns; ++row) {
      if (row == column) continue;
      const double share = m[row][column] / m[column][column];
      for (std::size_t k = 0; k < kUnknowns; ++k) m[row][k] -= share * m[column][k];
      right[row] -= share * right[column];
    }
  }
  for (std::size_t row = 0; row < kUnknowns; ++row) right[row] /= m[row][row];
  return right;
}

/// What the window around a pixel says of it.
Estimate fit(const Grid<Estimate>& irradiance, const Grid<Guide>& guide, const Grid<SmoothFeatures>& features,
             int x, int y, const filter::Settings& settings) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Matrix normal_equations{};
  std::array<Vector, 3> right{};
  Rgba lowest{infinity, infinity, infinity};
  Rgba highest{-infinity, -infinity, -infinity};
  double noise = 0;
  for (int j = -settings.smooth_radius; j <= settings.smooth_radius; ++j) {
    for (int i = -settings.smooth_radius; i <= settings.smooth_radius; ++i) {
      if (x + i < 0 || x + i >= guide.width || y + j < 0 || y + j >= guide.height) continue;
      const Estimate& value = irradiance.at(x + i, y + j);
      const double distance = std::max(patch_distance(guide, x, y, i, j, settings), 0.0);
      const double weight = std::floor(255 * std::exp(-distance) + 0.5) / 255 * value.count *
                            surface_weight(features, x, y, i, j, settings);
      if (weight <= 0) continue;
      Vector row{};
      for (std::size_t f = 0; f < kFeatures; ++f)
        row[f] = features.at(x + i, y + j)[f] - features.at(x, y)[f];
      row[kFeatures] = 1;
      for (std::size_t r = 0; r < kUnknowns; ++r) {
        for (std::size_t s = 0; s < kUnknowns; ++s) normal_equations[r][s] += weight * row[r] * row[s];
        for (std::size_t c = 0; c < 3; ++c) right[c][r] += weight * row[r] * value.color[c];
      }
      for (std::size_t c = 0; c < 3; ++c) {
        lowest[c] = std::min(lowest[c], value.color[c]);
        highest[c] = std::max(highest[c], value.color[c]);
      }
      noise += weight * guide.at(x + i, y + j).variance;
    }
  }
  const double weights = normal_equations[kFeatures][kFeatures];
  if (weights <= 0) return {};
  Rgba mean;
  for (std::size_t c = 0; c < 3; ++c) mean[c] = right[c][kFeatures] / weights;
  for (std::size_t f = 0; f < kFeatures; ++f) normal_equations[f][f] += 3e-4 * weights;
  Estimate fitted{{}, noise / weights, 1.0};
  Rgba linear;
  double share = 1;  // of the linear fit, the rest being the mean
  for (std::size_t c = 0; c < 3; ++c) {
    linear[c] = solve(normal_equations, right[c])[kFeatures];
    if (linear[c] > highest[c]) share = std::min(share, (highest[c] - mean[c]) / (linear[c] - mean[c]));
    if (linear[c] < lowest[c]) share = std::min(share, (mean[c] - lowest[c]) / (mean[c] - linear[c]));
  }
  for (std::size_t c = 0; c < 3; ++c) fitted.color[c] = std::lerp(mean[c], linear[c], share);
  Vector of_value{};
  of_value[kFeatures] = 1;
  fitted.variance *= solve(normal_equations, of_value)[kFeatures];
  return fitted;
}

}  // namespace

Grid<Estimate> smooth(const Grid<Estimate>& sample, const Grid<SmoothFeatures>& features, double exposure,
                      const filter::Settings& settings) {
  const int width = sample.width;
  const int height = sample.height;
  Grid<Estimate> irradiance(width, height);
  Grid<Guide> guide(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Estimate& e = irradiance.at(x, y);
      e.count = sample.at(x, y).count;
      for (std::size_t c = 0; c < 3; ++c) {
        e.color[c] = sample.at(x, y).color[c] * exposure / divisor(features.at(x, y), c);
      }
      Guide& g = guide.at(x, y);
      g.luminance = 0.2126 * e.color[0] + 0.7152 * e.color[1] + 0.0722 * e.color[2];
      double count = 0;
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          const Estimate& near = sample.clamped(x + i, y + j);
          g.variance += near.count * near.variance / mean_square(features.clamped(x + i, y + j), exposure);
          count += near.count;
        }
      }
      g.variance /= std::max(count, 1.0);
      const Estimate& own = sample.at(x, y);
      const double own_noise = own.count * own.variance / mean_square(features.at(x, y), exposure);
      g.variance = std::min(g.variance, own_noise + std::pow(32 * std::max(std::abs(g.luminance), 1.0), 2));
    }
  }
  Grid<Estimate> smoothed = sample;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (sample.at(x, y).count <= 0) continue;
      const Estimate fitted = fit(irradiance, guide, features, x, y, settings);
      Estimate& out = smoothed.at(x, y);
      for (std::size_t c = 0; c < 3; ++c) {
        out.color[c] = fitted.color[c] * divisor(features.at(x, y), c) / exposure;
      }
      out.variance = fitted.variance * mean_square(features.at(x, y), exposure);
    }
  }
  return smoothed;
}

}  // namespace becalm::reference
