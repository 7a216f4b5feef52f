#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "frame/audit/audit.h"
#include "frame/audit/pixels.h"

namespace becalm::audit {
namespace {

constexpr int kCellPx = 4;  // pixels are averaged into cells, which have less noise
/// The check needs so many cells, and an edge of the albedo above kEdge in this share of them.
constexpr std::size_t kLeastCells = 500;
constexpr double kEdge = 0.1;
constexpr double kShareOfEdges = 0.05;
/// A flip must raise the edges' correlation by this much: flipping a correct albedo raised it by at most 0.14
/// in 115 random shots of two renderers.
constexpr double kLeastGain = 0.2;

struct Grid {
  int width;
  int height;
  std::vector<double> values;

  double at(int x, int y) const { return values[static_cast<std::size_t>(y) * width + x]; }
};

/// Means over cells.
Grid cells(const Image& image) {
  const std::vector<float> values = brightness(image);
  Grid grid{image.width() / kCellPx, image.height() / kCellPx, {}};
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      double sum = 0.0;
      for (int i = 0; i < kCellPx * kCellPx; ++i) {
        const std::size_t row = static_cast<std::size_t>(y) * kCellPx + i / kCellPx;
        sum += values[row * image.width() + static_cast<std::size_t>(x) * kCellPx + i % kCellPx];
      }
      grid.values.push_back(std::max(sum, 0.0) / (kCellPx * kCellPx));
    }
  }
  return grid;
}

/// How much each cell differs from those to its right and below, up to 1.
Grid edges(const Grid& grid) {
  Grid result{grid.width - 1, grid.height - 1, {}};
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      const double here = grid.at(x, y);
      const double change = std::abs(grid.at(x + 1, y) - here) + std::abs(grid.at(x, y + 1) - here);
      result.values.push_back(std::min(change, 1.0));
    }
  }
  return result;
}

Grid flipped(const Grid& grid, bool x_too, bool y_too) {
  Grid result = grid;
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      result.values[static_cast<std::size_t>(y) * grid.width + x] =
          grid.at(x_too ? grid.width - 1 - x : x, y_too ? grid.height - 1 - y : y);
    }
  }
  return result;
}

double correlation(const Grid& a, const Grid& b) {
  const double count = static_cast<double>(a.values.size());
  double sum_a = 0.0;
  double sum_b = 0.0;
  double of_a = 0.0;
  double of_b = 0.0;
  double of_both = 0.0;
  for (std::size_t i = 0; i < a.values.size(); ++i) {
    sum_a += a.values[i];
    sum_b += b.values[i];
    of_a += a.values[i] * a.values[i];
    of_b += b.values[i] * b.values[i];
    of_both += a.values[i] * b.values[i];
  }
  const double spread = (of_a - sum_a * sum_a / count) * (of_b - sum_b * sum_b / count);
  return spread > 0.0 ? (of_both - sum_a * sum_b / count) / std::sqrt(spread) : 0.0;
}

}  // namespace

std::optional<Finding> check_albedo_flipped(const Subject& subject) {
  if (!subject.frame.has(Aov::albedo)) return std::nullopt;
  const Grid albedo = cells(subject.frame.image(Aov::albedo));
  Grid light = cells(subject.frame.image(Aov::beauty));
  if (albedo.width < 2 || albedo.height < 2) return std::nullopt;
  double mean = 0.0;
  for (const double value : light.values) mean += value / static_cast<double>(light.values.size());
  if (!(mean > 0.0)) return std::nullopt;
  for (double& value : light.values) value = std::log(value / mean + 1e-3);
  const Grid of_light = edges(light);
  const Grid of_albedo = edges(albedo);
  const auto strong = std::ranges::count_if(of_albedo.values, [](double edge) { return edge > kEdge; });
  const std::size_t count = of_albedo.values.size();
  if (count < kLeastCells || static_cast<double>(strong) < kShareOfEdges * static_cast<double>(count)) {
    return std::nullopt;
  }
  const double as_it_is = correlation(of_light, of_albedo);
  struct Flip {
    const char* text;
    bool x;
    bool y;
  };
  constexpr std::array<Flip, 3> flips{
      {{"turned upside down", false, true}, {"mirrored", true, false}, {"turned around", true, true}}};
  for (const Flip& flip : flips) {
    const double then = correlation(of_light, flipped(of_albedo, flip.x, flip.y));
    if (then < as_it_is + kLeastGain) continue;
    return Finding{
        "albedo_flipped",
        fmt::format("the albedo's edges are the beauty's if it is {} (correlation {:.2f}, and {:.2f} as "
                    "it is): write it as the beauty is, or use --layers albedo=none",
                    flip.text, then, as_it_is)};
  }
  return std::nullopt;
}

}  // namespace becalm::audit
