#include "filter/sequence/cuts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/ceil_div.h"
#include "filter/for_rows.h"
#include "filter/luminance.h"

namespace becalm::filter {
namespace {

/// Cells along the longer side. No cell is smaller than kSmallestCell pixels, so that noise averages out.
constexpr int kCells = 24;
constexpr int kSmallestCell = 8;
/// Largest movement of a cell between two frames, in cells: a twelfth of the image.
constexpr int kLargestMove = 2;
/// Largest differences between similar cells.
constexpr float kLuminanceDifference = 0.1f;
constexpr float kAlbedoDifference = 0.1f;
constexpr float kNormalDifference = 0.3f;
/// A cut has a larger share of cells without a match than this.
constexpr double kCutByGuides = 0.15;
constexpr double kCutByLuminance = 0.03;

/// Sum and number of the finite values in a cell.
struct CellMean {
  void add(float value) {
    if (!std::isfinite(value)) return;
    sum += value;
    ++count;
  }
  float mean() const { return count > 0 ? static_cast<float>(sum / count) : 0.0f; }

  double sum = 0.0;
  int count = 0;
};

bool is_known(const ShotSignature::Cell& cell) {
  return !std::isnan(cell[0]);
}

/// The largest of the cells' differences, each relative to the largest difference of similar cells.
float difference(const ShotSignature::Cell& a, const ShotSignature::Cell& b, bool guides) {
  if (!guides) return std::abs(a[0] - b[0]) / kLuminanceDifference;
  const float normal = std::hypot(a[2] - b[2], a[3] - b[3], a[4] - b[4]);
  return std::max(std::abs(a[1] - b[1]) / kAlbedoDifference, normal / kNormalDifference);
}

/// Share of all cells of `a` that are known, and have known cells nearby in `b`, but no similar one.
double unmatched(const ShotSignature& a, const ShotSignature& b) {
  int count = 0;
  for (int y = 0; y < a.rows; ++y) {
    for (int x = 0; x < a.columns; ++x) {
      const auto& cell = a.cells[static_cast<std::size_t>(y) * a.columns + x];
      if (!is_known(cell)) continue;
      bool matched = false, comparable = false;
      for (int v = std::max(y - kLargestMove, 0); v <= std::min(y + kLargestMove, a.rows - 1); ++v) {
        for (int u = std::max(x - kLargestMove, 0); u <= std::min(x + kLargestMove, a.columns - 1); ++u) {
          const auto& other = b.cells[static_cast<std::size_t>(v) * b.columns + u];
          if (!is_known(other)) continue;
          comparable = true;
          matched |= difference(cell, other, a.guides) <= 1.0f;
        }
      }
      count += comparable && !matched ? 1 : 0;
    }
  }
  return static_cast<double>(count) / static_cast<double>(a.cells.size());
}

}  // namespace

ShotSignature shot_signature(const Frame& frame, const AovSet& used, float exposure) {
  const int longer = std::max(frame.width(), frame.height());
  const int cell_px = std::max(ceil_div(longer, kCells), kSmallestCell);
  const bool albedo = contains(used, Aov::albedo) && frame.has(Aov::albedo);
  const bool normal = contains(used, Aov::normal) && frame.has(Aov::normal);
  ShotSignature signature{.columns = ceil_div(frame.width(), cell_px),
                          .rows = ceil_div(frame.height(), cell_px),
                          .guides = albedo || normal,
                          .cells = {}};
  std::vector<std::array<CellMean, 5>> means(static_cast<std::size_t>(signature.columns) * signature.rows);
  const auto add_row = [&](int y) {
    for (int x = 0; x < frame.width(); ++x) {
      auto& cell = means[static_cast<std::size_t>(y / cell_px) * signature.columns + x / cell_px];
      const float radiance = luminance(frame.image(Aov::beauty).pixel(x, y)) * exposure;
      if (std::isnan(radiance)) continue;
      const float light = std::max(radiance, 0.0f);
      cell[0].add(std::isinf(light) ? 1.0f : light / (1.0f + light));
      if (albedo) cell[1].add(std::clamp(luminance(frame.image(Aov::albedo).pixel(x, y)), 0.0f, 1.0f));
      for (int c = 0; normal && c < 3; ++c)
        cell[2 + c].add(std::clamp(frame.image(Aov::normal).at(x, y, c), -1.0f, 1.0f));
    }
  };
  for_each_in_parallel(signature.rows, [&](int row) {
    for (int y = row * cell_px; y < std::min((row + 1) * cell_px, frame.height()); ++y) add_row(y);
  });
  for (const auto& cell : means) {
    auto& out = signature.cells.emplace_back();
    std::ranges::transform(cell, out.begin(), [](const CellMean& mean) { return mean.mean(); });
    if (cell[0].count == 0) out[0] = std::numeric_limits<float>::quiet_NaN();
  }
  return signature;
}

bool has_known_cells(const ShotSignature& signature) {
  return std::ranges::any_of(signature.cells, is_known);
}

bool is_cut(const ShotSignature& a, const ShotSignature& b) {
  const double share = std::max(unmatched(a, b), unmatched(b, a));
  return share > (a.guides ? kCutByGuides : kCutByLuminance);
}

}  // namespace becalm::filter
