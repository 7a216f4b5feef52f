#include "tests/filter/reference/burst.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "filter/burst/cfa_weights.h"

namespace becalm::reference {
namespace {

/// A sample of the same phase of the pattern inside of the image.
double sample(const Grid<double>& grid, int x, int y, int period) {
  while (x < 0) x += period;
  while (y < 0) y += period;
  while (x >= grid.width) x -= period;
  while (y >= grid.height) y -= period;
  return grid.at(x, y);
}

double variance(const NoiseModel& noise, double signal) {
  return std::max(noise.a * std::max(signal, 0.0) + noise.b, 1e-12);
}

/// A frame's weight against the reference's 1, from the differences of a patch.
double weight_of(double sum, double squares, double count, double own, double other) {
  const double excess = std::max(squares / count - 1.25, (sum / count) * (sum / count) - 4.0 / count);
  const double bias = std::max(excess, 0.0) * (own + other);
  const double t = std::clamp((excess - 0.5) / (4.0 - 0.5), 0.0, 1.0);
  return own / (other + bias) * (1.0 - (3.0 - 2.0 * t) * t * t);
}

}  // namespace

Read read(const Grid<double>& mosaic, const CfaPattern& cfa, std::span<const float> weights, int color,
          double x, double y, double saturated) {
  using filter::kCfaBefore, filter::kCfaSteps, filter::kCfaTaps;
  const int fine_x = static_cast<int>(std::floor(kCfaSteps * x + 0.5));
  const int fine_y = static_cast<int>(std::floor(kCfaSteps * y + 0.5));
  if (fine_x < 0 || fine_y < 0 || fine_x > kCfaSteps * (mosaic.width - 1) ||
      fine_y > kCfaSteps * (mosaic.height - 1))
    return {};
  const int px = fine_x / kCfaSteps, py = fine_y / kCfaSteps;
  const int pixel = (py % cfa.period) * cfa.period + px % cfa.period;
  const int place = (fine_y % kCfaSteps) * kCfaSteps + fine_x % kCfaSteps;
  const int row = ((pixel * kCfaSteps * kCfaSteps + place) * 3 + color) * kCfaTaps * kCfaTaps;
  Read result;
  for (int j = 0; j < kCfaTaps; ++j) {
    for (int i = 0; i < kCfaTaps; ++i) {
      const double w = weights[row + j * kCfaTaps + i];
      const double value = sample(mosaic, px + i - kCfaBefore, py + j - kCfaBefore, cfa.period);
      if (w != 0.0 && value >= saturated) return {};
      result.value += w * value;
      result.ratio += w * w;
    }
  }
  return result;
}

Grid<Accumulated> burst_addition(const Grid<double>& reference, const Grid<double>& frame,
                                 const Grid<Vec2>& offset, int block, const CfaPattern& cfa,
                                 const BurstLevels& levels) {
  const int width = reference.width, height = reference.height;
  const std::vector<float> weights =
      filter::cfa_weights(cfa, {static_cast<float>(levels.balance[0]), static_cast<float>(levels.balance[1]),
                                static_cast<float>(levels.balance[2])});
  Grid<double> offset_x(offset.width, offset.height), offset_y(offset.width, offset.height);
  for (std::size_t i = 0; i < offset.data.size(); ++i) {
    offset_x.data[i] = offset.data[i].x;
    offset_y.data[i] = offset.data[i].y;
  }
  struct Difference {
    double d = 0.0;
    bool usable = false;
  };
  Grid<Read> warped(width, height);
  Grid<Difference> difference(width, height);
  Grid<double> own(width, height), other(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double bx = (x + 0.5) / block - 0.5, by = (y + 0.5) / block - 0.5;
      const Read h = read(frame, cfa, weights, cfa.color(x, y), x + block * bilinear(offset_x, bx, by),
                          y + block * bilinear(offset_y, bx, by), levels.frame_saturated);
      const double value = reference.at(x, y);
      const double signal = 0.5 * (value + h.value);
      warped.at(x, y) = h;
      own.at(x, y) = variance(levels.reference_noise, signal);
      other.at(x, y) = h.ratio * variance(levels.frame_noise, signal);
      if (h.ratio > 0.0 && value < levels.reference_saturated) {
        const double d = (value - h.value) / std::sqrt(own.at(x, y) + other.at(x, y));
        difference.at(x, y) = {std::clamp(d, -64.0, 64.0), true};
      }
    }
  }
  Grid<Accumulated> result(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (!difference.at(x, y).usable) continue;
      double sum = 0.0, squares = 0.0, count = 0.0;
      for (int v = std::max(y - 2, 0); v <= std::min(y + 2, height - 1); ++v) {
        for (int u = std::max(x - 2, 0); u <= std::min(x + 2, width - 1); ++u) {
          if ((cfa.color(u, v) == 1) != (cfa.color(x, y) == 1)) continue;
          const Difference& d = difference.at(u, v);
          sum += d.d;
          squares += d.d * d.d;
          count += d.usable ? 1.0 : 0.0;
        }
      }
      const double weight = weight_of(sum, squares, count, own.at(x, y), other.at(x, y));
      result.at(x, y) = {weight * warped.at(x, y).value, weight};
    }
  }
  return result;
}

double block_feature(const Grid<double>& mosaic, int column, int row, int block, const CfaPattern& cfa,
                     const NoiseModel& noise) {
  double mean = 0.0, shares = 0.0;
  for (int color = 0; color < 3; ++color) {
    double sum = 0.0, count = 0.0, of_pattern = 0.0;
    for (int y = 0; y < cfa.period; ++y) {
      for (int x = 0; x < cfa.period; ++x) of_pattern += cfa.color(x, y) == color ? 1.0 : 0.0;
    }
    for (int y = row * block; y < (row + 1) * block; ++y) {
      for (int x = column * block; x < (column + 1) * block; ++x) {
        if (cfa.color(x, y) != color) continue;
        sum += sample(mosaic, x, y, cfa.period);
        count += 1.0;
      }
    }
    if (count == 0.0) continue;
    mean += of_pattern * sum / count;
    shares += of_pattern;
  }
  mean /= shares;
  // Anscombe's transform, less its value at black.
  const double c = std::max(0.375 * noise.a * noise.a + noise.b, 1e-12);
  const double value = mean <= 0.0     ? mean / std::sqrt(c)
                       : noise.a > 0.0 ? 2.0 / noise.a * (std::sqrt(noise.a * mean + c) - std::sqrt(c))
                                       : mean / std::sqrt(c);
  return block * value;
}

}  // namespace becalm::reference
