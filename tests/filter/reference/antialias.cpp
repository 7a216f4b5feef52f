#include "tests/filter/reference/antialias.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "frame/jitter.h"

namespace becalm::reference {
namespace {

using filter::Accumulate;
using filter::AntialiasSettings;
using filter::Bounds;
using filter::Rectify;

/// That a history counts as.
constexpr double kLongestHistory = 64.0;

/// Of the tiles whose light is compared, in pixels.
constexpr int kTileSide = 8;

Rgb operator-(const Rgb& a, const Rgb& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double mean_square(const Rgb& d) {
  return (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / 3.0;
}

/// The pixels of the 3x3 around one that lie inside, as tap and value.
template <class T>
std::vector<std::pair<int, T>> around(const Grid<T>& grid, int x, int y) {
  std::vector<std::pair<int, T>> taps;
  for (int k = 0; k < 9; ++k) {
    const int qx = x + k % 3 - 1;
    const int qy = y + k / 3 - 1;
    if (qx >= 0 && qy >= 0 && qx < grid.width && qy < grid.height) taps.emplace_back(k, grid.at(qx, qy));
  }
  return taps;
}

/// Of the 3x3 samples: their variance (Philippi et al. 2022, eq. 10) and the mean squared difference from the
/// history (eq. 11), averaged over channels.
std::pair<double, double> spread_and_difference(const Grid<Rgb>& samples, int x, int y, const Rgb& history) {
  const auto taps = around(samples, x, y);
  const double n = static_cast<double>(taps.size());
  Rgb mean{};
  for (const auto& [k, value] : taps) {
    for (int c = 0; c < 3; ++c) mean[c] += value[c] / n;
  }
  double spread = 0.0;
  double difference = 0.0;
  for (const auto& [k, value] : taps) {
    spread += mean_square(value - mean) / n;
    difference += mean_square(history - value) / n;
  }
  return {spread, difference};
}

struct Estimated {
  double variance;  ///< of the new frame
  double bias_squared;
};

Estimated variance_and_bias(const Grid<Antialiased>& frame, const Grid<Antialiased>& history, int x, int y) {
  double squares = 0.0;
  double noise = 0.0;
  double count = 0.0;
  for (const auto& [k, now] : around(frame, x, y)) {
    const Antialiased& before = history.at(x + k % 3 - 1, y + k / 3 - 1);
    if (before.count <= 0.0) continue;
    squares += mean_square(now.color - before.color);
    noise += now.variance;
    count += 1.0;
  }
  const double variance = noise / std::max(count, 1.0);
  const double expected = 0.5 * variance * (1.0 + 1.0 / history.at(x, y).count);
  const double own = mean_square(frame.at(x, y).color - history.at(x, y).color);
  return {variance, std::max({0.0, squares / std::max(count, 1.0) - expected, own - 9.0 * expected})};
}

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Sums over pixels of a tile that have a history.
struct Tile {
  Rgb frame{}, history{};
  double weight = 0.0;
};

Grid<Tile> tiles_of(const Grid<Antialiased>& frame, const Grid<Antialiased>& history) {
  Grid<Tile> tiles((frame.width + kTileSide - 1) / kTileSide, (frame.height + kTileSide - 1) / kTileSide);
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      if (history.at(x, y).count <= 0.0) continue;
      Tile& tile = tiles.at(x / kTileSide, y / kTileSide);
      tile.weight += 1.0;
      for (int c = 0; c < 3; ++c) {
        tile.frame[c] += frame.at(x, y).color[c];
        tile.history[c] += history.at(x, y).color[c];
      }
    }
  }
  return tiles;
}

/// By what the history of a tile is multiplied in a channel: 1, or the ratio of the lights of the 9x9 tiles
/// around if these share it.
double light_ratio(const Grid<Tile>& tiles, int tile_x, int tile_y, int c) {
  const auto over_tiles = [&](const auto& call) {
    const int left = std::clamp(tile_x - 4, 0, std::max(tiles.width - 9, 0));
    const int top = std::clamp(tile_y - 4, 0, std::max(tiles.height - 9, 0));
    for (int y = top; y < std::min(top + 9, tiles.height); ++y) {
      for (int x = left; x < std::min(left + 9, tiles.width); ++x) {
        call(tiles.at(x, y), std::max(std::abs(x - tile_x), std::abs(y - tile_y)) <= 1);
      }
    }
  };
  double frame = 0.0, history = 0.0, near_frame = 0.0, near_history = 0.0, weight = 0.0, weight_squares = 0.0;
  over_tiles([&](const Tile& tile, bool is_near) {
    frame += tile.frame[c];
    history += tile.history[c];
    near_frame += is_near ? tile.frame[c] : 0.0;
    near_history += is_near ? tile.history[c] : 0.0;
    weight += tile.weight;
    weight_squares += tile.weight * tile.weight;
  });
  const double n = weight_squares > 0.0 ? weight * weight / weight_squares : 0.0;
  if (n < 8.0 || std::min(frame, history) <= 0.0) return 1.0;
  const double ratio = frame / history;
  double squares = 0.0, frame_squares = 0.0, history_squares = 0.0;
  over_tiles([&](const Tile& tile, bool) {
    squares += std::pow(tile.frame[c] - ratio * tile.history[c], 2) / std::min(ratio * ratio, 1.0);
    frame_squares += std::pow(tile.frame[c], 2);
    history_squares += std::pow(tile.history[c], 2);
  });
  const double least = 1e-6 * std::max(frame_squares, history_squares);
  const double significance = std::pow(frame - history, 2) / n / (std::max(squares, least) / (n - 1.0));
  const double share = (near_frame - near_history) / ((ratio - 1.0) * near_history);
  const double here = ratio != 1.0 && near_history != 0.0 ? smoothstep(0.25, 0.75, share) : 0.0;
  return 1.0 + here * smoothstep(9.0, 36.0, significance) * (ratio - 1.0);
}

/// The history in the light of the frame.
Grid<Antialiased> in_light_of(const Grid<Antialiased>& frame, Grid<Antialiased> history) {
  const Grid<Tile> tiles = tiles_of(frame, history);
  Grid<Rgb> ratios(tiles.width, tiles.height);
  for (int y = 0; y < tiles.height; ++y) {
    for (int x = 0; x < tiles.width; ++x) {
      for (int c = 0; c < 3; ++c) ratios.at(x, y)[c] = light_ratio(tiles, x, y, c);
    }
  }
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      const double u = std::clamp((x + 0.5) / kTileSide - 0.5, 0.0, tiles.width - 1.0);
      const double v = std::clamp((y + 0.5) / kTileSide - 0.5, 0.0, tiles.height - 1.0);
      const int left = static_cast<int>(u), top = static_cast<int>(v);
      const int right = std::min(left + 1, tiles.width - 1), bottom = std::min(top + 1, tiles.height - 1);
      Antialiased& pixel = history.at(x, y);
      double squares = 0.0;
      for (int c = 0; c < 3; ++c) {
        const double ratio =
            std::lerp(std::lerp(ratios.at(left, top)[c], ratios.at(right, top)[c], u - left),
                      std::lerp(ratios.at(left, bottom)[c], ratios.at(right, bottom)[c], u - left), v - top);
        pixel.color[c] *= ratio;
        squares += ratio * ratio / 3.0;
      }
      pixel.variance *= squares;
    }
  }
  return history;
}

}  // namespace

Grid<Antialiased> reconstruct(const Grid<Rgb>& samples, const std::array<double, 10>& weights) {
  Grid<Antialiased> frame(samples.width, samples.height);
  for (int y = 0; y < samples.height; ++y) {
    for (int x = 0; x < samples.width; ++x) {
      const auto taps = around(samples, x, y);
      double sum = 0.0;
      double squares = 0.0;
      Rgb mean{};
      for (const auto& [k, value] : taps) {
        const double w = weights[9] > 0.0 ? weights[k] : (k == 4 ? 1.0 : 0.0);
        sum += w;
        squares += w * w;
        for (int c = 0; c < 3; ++c) mean[c] += w * value[c];
      }
      for (double& c : mean) c /= sum;
      double spread = 0.0;
      for (const auto& [k, value] : taps) {
        if (weights[9] > 0.0) spread += weights[k] * mean_square(value - mean);
      }
      const double n = sum * sum / squares;
      const double of_samples = spread_and_difference(samples, x, y, mean).first;
      frame.at(x, y) = {mean, n < 1.5 ? of_samples / n : spread / (sum * (n - 1.0)), 1.0};
    }
  }
  return frame;
}

Grid<Antialiased> reconstruct_sparse(const Grid<Rgb>& samples, const std::array<double, 2>& position,
                                     double scale, double wide_radius,
                                     const std::function<bool(int x, int y)>& holds) {
  constexpr double radius = 1.5;
  const auto window = [&](double distance_px) {
    const double t = std::abs(distance_px) / radius;
    return t > 1.0 ? 0.0 : blackman_harris_window(t) / (2.0 * radius * kBlackmanHarrisMean);
  };
  const auto tent = [&](double distance_px) {
    return std::max(1.0 - std::abs(distance_px) / wide_radius, 0.0) / wide_radius;
  };
  const int width = static_cast<int>(std::floor(samples.width * scale + 0.5));
  const int height = static_cast<int>(std::floor(samples.height * scale + 0.5));
  Grid<Antialiased> frame(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double at_x = (x + 0.5) / scale - 0.5;
      const double at_y = (y + 0.5) / scale - 0.5;
      Rgb sum{};
      double weight = 0.0;
      for (int j = 0; j < samples.height; ++j) {
        for (int i = 0; i < samples.width; ++i) {
          if (!holds(i, j)) continue;
          const double dx = i + position[0] - at_x;
          const double dy = j + position[1] - at_y;
          const double w =
              window(scale * dx) * window(scale * dy) + 0.3 * tent(dx) * tent(dy) / (scale * scale);
          weight += w;
          for (int c = 0; c < 3; ++c) sum[c] += w * samples.at(i, j)[c];
        }
      }
      Antialiased& result = frame.at(x, y);
      result.count = weight > 0.0 ? std::min(weight, 1.0) : 0.0;
      for (int c = 0; c < 3; ++c) result.color[c] = weight > 0.0 ? sum[c] / weight : 0.0;
    }
  }
  return frame;
}

Rgb rectified(const Grid<Rgb>& samples, int x, int y, const Rgb& history, const AntialiasSettings& settings) {
  if (settings.rectify == Rectify::none) return history;
  const auto taps = around(samples, x, y);
  const double n = static_cast<double>(taps.size());
  Rgb h = history;
  for (int c = 0; c < 3; ++c) {
    double least = INFINITY, most = -INFINITY, sum = 0.0, squares = 0.0;
    for (const auto& [k, value] : taps) {
      least = std::min(least, value[c]);
      most = std::max(most, value[c]);
      sum += value[c];
      squares += value[c] * value[c];
    }
    const double mean = sum / n;
    const double deviation = std::sqrt(std::max(squares / n - mean * mean, 0.0));
    const bool by_deviation = settings.bounds == Bounds::deviation;
    h[c] = std::clamp(h[c], by_deviation ? mean - deviation : least, by_deviation ? mean + deviation : most);
  }
  return h;
}

Grid<Antialiased> accumulate(const Grid<Rgb>& samples, const Grid<Antialiased>& frame,
                             const Grid<Antialiased>& found, const AntialiasSettings& settings) {
  const bool follows_light = settings.accumulate == Accumulate::variance;
  const Grid<Antialiased> history = follows_light ? in_light_of(frame, found) : found;
  Grid<Antialiased> next(frame.width, frame.height);
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      const Antialiased& now = frame.at(x, y);
      const Antialiased& before = history.at(x, y);
      Antialiased& result = next.at(x, y);
      if (before.count <= 0.0) {
        result = now;
        continue;
      }
      const Rgb h = rectified(samples, x, y, before.color, settings);
      const double even = 1.0 / (std::min(before.count, kLongestHistory - 1.0) + 1.0);
      double alpha = 0.0;
      double bias = 0.0;
      switch (settings.accumulate) {
        case Accumulate::exponential:
          alpha = 0.1;
          break;
        case Accumulate::gain: {
          const auto [spread, difference] = spread_and_difference(samples, x, y, before.color);
          alpha = std::max(difference > 0.0 ? 1.0 - spread / difference : 0.0, even);
          break;
        }
        case Accumulate::variance: {
          const Estimated found = variance_and_bias(frame, history, x, y);
          bias = found.bias_squared;
          const double old_error = found.variance / before.count + bias;
          alpha = old_error > 0.0 ? old_error / (old_error + found.variance) : even;
          alpha = std::max(alpha, 1.0 / kLongestHistory);
          break;
        }
      }
      for (int c = 0; c < 3; ++c) result.color[c] = h[c] + alpha * (now.color[c] - h[c]);
      const double rest = 1.0 - alpha;
      result.variance = rest * rest * (before.variance + bias) + alpha * alpha * now.variance;
      result.count = std::min(before.count / (alpha * alpha * before.count + rest * rest), kLongestHistory);
    }
  }
  return next;
}

}  // namespace becalm::reference
