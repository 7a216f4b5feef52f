#include "filter/burst/noise_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "filter/for_rows.h"

namespace becalm::filter {
namespace {

/// Side of the blocks in pixels: a multiple of both periods.
constexpr int kBlock = 12;
/// Share of the blocks of like brightness that counts as flat.
constexpr double kFlatShare = 0.1;
constexpr std::size_t kBins = 24;
constexpr std::size_t kLeastInBin = 20;

/// The distance between equal phases of a pattern of two, or the next sample in a 2x2 square of one colour.
int step_of(const CfaPattern& cfa) {
  return cfa.period == 2 ? 2 : 1;
}

/// Second differences of four samples of one colour in a square. The squares of Bayer's pattern do not
/// overlap; X-Trans has squares of green.
NoiseBlock statistics_of(const Mosaic& mosaic, int left, int top, float saturated) {
  const Image& samples = mosaic.samples;
  const int step = step_of(mosaic.cfa);
  double sum = 0.0, squares = 0.0;
  int count = 0;
  for (int y = top; y + step < top + kBlock; ++y) {
    if (step == 2 && y % 4 > 1) continue;
    for (int x = left; x + step < left + kBlock; ++x) {
      if (step == 2 && x % 4 > 1) continue;
      const int color = mosaic.cfa.color(x, y);
      if (mosaic.cfa.color(x + step, y) != color || mosaic.cfa.color(x, y + step) != color ||
          mosaic.cfa.color(x + step, y + step) != color)
        continue;
      const float a = samples.at(x, y, 0), b = samples.at(x + step, y, 0);
      const float c = samples.at(x, y + step, 0), d = samples.at(x + step, y + step, 0);
      if (std::max({a, b, c, d}) >= saturated) return {};
      sum += (static_cast<double>(a) + b + c + d) / 4.0;
      const double difference = (static_cast<double>(a) - b - c + d) / 2.0;
      squares += difference * difference;
      ++count;
    }
  }
  if (count == 0) return {};
  return {.mean = sum / count, .variance = squares / count, .count = count};
}

/// One point of the curve of variance over brightness.
struct Point {
  double mean;
  double variance;
};

/// Expected mean of the lowest share `kFlatShare` of estimates of a variance 1, each from `count` squared
/// normal deviates: by the normal approximation of the chi-squared distribution by Wilson and Hilferty.
double lowest_share_mean(int count) {
  // Quantiles of the normal distribution in the middle of ten equal parts of the lowest 10 %.
  constexpr double quantiles[] = {-2.5758, -2.1701, -1.9600, -1.8119, -1.6954,
                                  -1.5982, -1.5141, -1.4395, -1.3722, -1.3106};
  const double spread = 2.0 / (9.0 * count);
  double sum = 0.0;
  for (const double z : quantiles) {
    sum += std::pow(std::max(1.0 - spread + z * std::sqrt(spread), 0.0), 3.0);
  }
  return sum / std::size(quantiles);
}

std::vector<Point> curve_of(std::vector<NoiseBlock> blocks) {
  std::ranges::sort(blocks, {}, &NoiseBlock::mean);
  const std::size_t bins = std::clamp<std::size_t>(blocks.size() / kLeastInBin, 1, kBins);
  std::vector<Point> points;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const auto begin = blocks.begin() + static_cast<std::ptrdiff_t>(bin * blocks.size() / bins);
    const auto end = blocks.begin() + static_cast<std::ptrdiff_t>((bin + 1) * blocks.size() / bins);
    std::sort(begin, end, [](const auto& a, const auto& b) { return a.variance < b.variance; });
    const auto flat = std::max<std::ptrdiff_t>(1, std::lround(kFlatShare * static_cast<double>(end - begin)));
    Point point{0.0, 0.0};
    int count = 0;
    for (auto block = begin; block != begin + flat; ++block) {
      point.mean += block->mean / static_cast<double>(flat);
      point.variance += block->variance / static_cast<double>(flat);
      count += block->count;
    }
    point.variance /= lowest_share_mean(static_cast<int>(count / flat));
    points.push_back(point);
  }
  return points;
}

/// Sum of the points' relative distances from a line. Texture raises points: those above the line count less,
/// and all that are far above it as one.
double cost(const std::vector<Point>& points, const NoiseModel& line) {
  constexpr double far = 0.3;
  double sum = 0.0;
  for (const Point& point : points) {
    const double expected = line.a * std::max(point.mean, 0.0) + line.b;
    const double excess = expected > 0.0 ? point.variance / expected - 1.0 : far;
    sum += excess < 0.0 ? -4.0 * excess : std::min(excess, far);
  }
  return sum;
}

/// The line of least cost through two of the points, or one and the origin, or level through one, of those
/// neither of whose coefficients is negative.
NoiseModel best_line(const std::vector<Point>& points) {
  NoiseModel best;
  double least = cost(points, best);
  const auto consider = [&](const NoiseModel& line) {
    if (line.a < 0.0 || line.b < 0.0) return;
    const double of_line = cost(points, line);
    if (of_line >= least) return;
    least = of_line;
    best = line;
  };
  for (const Point& p : points) {
    consider({.a = 0.0, .b = p.variance});
    if (p.mean > 0.0) consider({.a = p.variance / p.mean, .b = 0.0});
    for (const Point& q : points) {
      if (q.mean <= p.mean) continue;
      const double slope = (q.variance - p.variance) / (q.mean - p.mean);
      consider({.a = slope, .b = p.variance - slope * p.mean});
    }
  }
  return best;
}

/// The line by least squares of relative distances from `line`, of the points that are not far from it.
NoiseModel refined(const std::vector<Point>& points, const NoiseModel& line) {
  constexpr double far = 0.15;
  double w_sum = 0, x_sum = 0, y_sum = 0, xx = 0, xy = 0;
  for (const Point& point : points) {
    const double x = std::max(point.mean, 0.0);
    const double expected = line.a * x + line.b;
    if (!(expected > 0.0) || std::abs(point.variance / expected - 1.0) > far) continue;
    const double w = 1.0 / (expected * expected);
    w_sum += w;
    x_sum += w * x;
    y_sum += w * point.variance;
    xx += w * x * x;
    xy += w * x * point.variance;
  }
  const double determinant = w_sum * xx - x_sum * x_sum;
  if (!(determinant > 1e-6 * w_sum * xx)) return line;
  const NoiseModel next{.a = (w_sum * xy - x_sum * y_sum) / determinant,
                        .b = (xx * y_sum - x_sum * xy) / determinant};
  return next.a < 0.0 || next.b < 0.0 ? line : next;
}

/// The line's variance at the darkest point; the point's own where the line tells 0, which no noise has.
double variance_of_darkest(const std::vector<Point>& points, const NoiseModel& line) {
  const Point& darkest = points.front();
  const double of_line = line.a * std::max(darkest.mean, 0.0) + line.b;
  return of_line > 0.0 ? of_line : darkest.variance;
}

}  // namespace

/// Colours have different means in Bayer's pattern, whose four phases share one block; the model is linear,
/// so that the block's mean variance belongs to its mean brightness.
std::vector<NoiseBlock> noise_blocks(const Mosaic& mosaic, float saturated) {
  const int rows = mosaic.samples.height() / kBlock;
  const int columns = mosaic.samples.width() / kBlock;
  std::vector<NoiseBlock> blocks(static_cast<std::size_t>(rows) * columns);
  for_rows(rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      for (int column = 0; column < columns; ++column) {
        blocks[static_cast<std::size_t>(row) * columns + column] =
            statistics_of(mosaic, column * kBlock, row * kBlock, saturated);
      }
    }
  });
  std::erase_if(blocks, [](const NoiseBlock& block) { return block.count == 0; });
  return blocks;
}

NoiseModel fit_noise(std::vector<NoiseBlock> blocks) {
  if (blocks.empty()) return {};
  const std::vector<Point> points = curve_of(std::move(blocks));
  NoiseModel noise = refined(points, best_line(points));
  if (noise.a + noise.b > 0.0) noise.b = std::max(noise.b, kFitError * variance_of_darkest(points, noise));
  return noise;
}

NoiseModel fit_noise(const Mosaic& mosaic, float saturated) {
  return fit_noise(noise_blocks(mosaic, saturated));
}

NoiseModel with_least_read_noise(NoiseModel noise, const NoiseModel& reference, double iso_ratio) {
  noise.b = std::max(noise.b, reference.b * std::min(1.0, iso_ratio * iso_ratio));
  return noise;
}

Contrast contrast_of(const Mosaic& mosaic) {
  const Image& samples = mosaic.samples;
  const int step = mosaic.cfa.period;
  const int columns = samples.width() - step, rows = samples.height() - step;
  if (columns <= 0 || rows <= 0) return {};
  const auto mean_of = [&](const auto& value) {
    const double sum = sum_of_rows<double>(rows, [&](int y) {
      double of_row = 0.0;
      for (int x = 0; x < columns; ++x) of_row += value(x, y);
      return of_row;
    });
    return sum / (static_cast<double>(columns) * rows);
  };
  return {.squared_differences = mean_of([&](int x, int y) {
            const double dx = samples.at(x + step, y, 0) - samples.at(x, y, 0);
            const double dy = samples.at(x, y + step, 0) - samples.at(x, y, 0);
            return dx * dx + dy * dy;
          }),
          .signal = mean_of([&](int x, int y) { return std::max(samples.at(x, y, 0), 0.0f); })};
}

double sharpness(const Contrast& contrast, const NoiseModel& noise, double noise_error) {
  // Two differences of two samples each.
  return contrast.squared_differences - 4.0 * (1.0 + noise_error) * (noise.a * contrast.signal + noise.b);
}

}  // namespace becalm::filter
