#include "tests/filter/reference/stereo.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace becalm::reference {
namespace {

double brightness(const Rgba& c, double exposure) {
  return std::max(luminance(c), 0.0) + 0.1 / exposure;
}

bool is_expected(double depth, double expected) {
  return depth == expected || std::abs(depth - expected) <= 0.05 * expected;
}

}  // namespace

Grid<Estimate> blend_eyes(const Grid<Estimate>& own, const Grid<Estimate>& other, double exposure, int radius,
                          filter::Smooth smooth, const Grid<double>& noisy_variance, Grid<double>& weights) {
  Grid<Estimate> result(own.width, own.height);
  weights = Grid<double>(own.width, own.height);
  for (int y = 0; y < own.height; ++y) {
    for (int x = 0; x < own.width; ++x) {
      const Estimate& e = own.at(x, y);
      const Estimate& o = other.at(x, y);
      Rgba mean{};
      double squares = 0, own_variance = 0, other_variance = 0, noise = 0;
      int count = 0;
      for (int v = std::max(y - radius, 0); v <= std::min(y + radius, own.height - 1); ++v) {
        for (int u = std::max(x - radius, 0); u <= std::min(x + radius, own.width - 1); ++u) {
          const Estimate& a = own.at(u, v);
          const Estimate& b = other.at(u, v);
          if ((u == x && v == y) || a.count <= 0 || b.count <= 0) continue;
          const double scale = 1 / brightness(b.color, exposure);
          for (int c = 0; c < 3; ++c) {
            mean[c] += (a.color[c] - b.color[c]) * scale;
            squares += std::pow((a.color[c] - b.color[c]) * scale, 2) / 3;
          }
          own_variance += a.variance * scale * scale;
          other_variance += b.variance * scale * scale;
          noise += explained_square(a, b, smooth, noisy_variance.at(u, v)) * scale * scale;
          ++count;
        }
      }
      double alpha = 1, bias = 0;
      if (count > 0) {
        own_variance /= count;
        other_variance /= count;
        double mean_square = 0;
        for (int c = 0; c < 3; ++c) mean_square += mean[c] * mean[c] / (3.0 * count * count);
        const double relative =
            patch_bias(mean_square, squares / count, noise / count, count, smooth != filter::Smooth::none);
        const double bright = brightness(o.color, exposure);
        const double total = own_variance + other_variance + relative;
        alpha = total > 0 ? 1 - own_variance / total : 1;
        bias = relative * bright * bright;
      }
      if (o.count <= 0) alpha = 1;
      if (e.count <= 0 && o.count > 0) alpha = 0;
      Estimate& r = result.at(x, y);
      weights.at(x, y) = 1 - alpha;
      if (alpha >= 1 || alpha <= 0) {
        r = alpha >= 1 ? e : o;
        continue;
      }
      for (int c = 0; c < 4; ++c) r.color[c] = alpha * e.color[c] + (1 - alpha) * o.color[c];
      r.variance = alpha * alpha * e.variance + (1 - alpha) * (1 - alpha) * (o.variance + bias);
      r.count = 1 / (alpha * alpha / e.count + (1 - alpha) * (1 - alpha) / o.count);
    }
  }
  return result;
}

Grid<Vec2> checked_offsets(const Grid<Vec2>& offsets, const Grid<double>& expected_depth,
                           const Grid<double>& other_depth) {
  Grid<Vec2> checked = offsets;
  for (int y = 0; y < offsets.height; ++y) {
    for (int x = 0; x < offsets.width; ++x) {
      if (!(expected_depth.at(x, y) > 0)) continue;
      const int left = x + static_cast<int>(std::floor(offsets.at(x, y).x));
      const int top = y + static_cast<int>(std::floor(offsets.at(x, y).y));
      bool sees = false;
      for (int v = top; v <= top + 1; ++v) {
        for (int u = left; u <= left + 1; ++u)
          sees = sees || is_expected(other_depth.clamped(u, v), expected_depth.at(x, y));
      }
      if (!sees) checked.at(x, y) = {1e6, 1e6};
    }
  }
  return checked;
}

}  // namespace becalm::reference
