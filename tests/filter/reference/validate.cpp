#include "tests/filter/reference/validate.h"

#include <limits>

namespace becalm::reference {
namespace {

using Axes = std::array<double, 3>;

double soft(double difference, double tolerance) {
  return tolerance * tolerance / (tolerance * tolerance + difference * difference);
}

double pixel_trust(const Grid<Surface>& now, int x, int y, const Surface& there,
                   const filter::Settings& settings) {
  const Surface& here = now.at(x, y);
  double result = 1;
  if (settings.validate & filter::validate_depth) {
    const auto inverse = [&](int u, int v) { return 1 / now.clamped(u, v).depth; };
    const auto slope = [&](int dx, int dy) {
      return std::min(std::abs(inverse(x, y) - inverse(x - dx, y - dy)),
                      std::abs(inverse(x + dx, y + dy) - inverse(x, y)));
    };
    const double a = 1 / here.depth;
    const double b = 1 / there.depth;
    const double beyond = std::max(0.0, std::abs(a - b) - slope(1, 0) - slope(0, 1));
    if (a > 0 || b > 0) result *= soft(beyond / std::max(a, b), settings.depth_tolerance);
  }
  if (settings.validate & filter::validate_normal) {
    double squared = 0;
    for (int c = 0; c < 3; ++c) {
      squared += (here.normal[c] - there.normal[c]) * (here.normal[c] - there.normal[c]);
    }
    result *= soft(std::sqrt(squared), settings.normal_tolerance);
  }
  if ((settings.validate & filter::validate_id) && here.id != there.id) result = 0;
  return result;
}

Axes to_axes(const Rgba& c, filter::ClipSpace space) {
  if (space == filter::ClipSpace::rgb) return {c[0], c[1], c[2]};
  return {c[0] / 4 + c[1] / 2 + c[2] / 4, c[0] / 2 - c[2] / 2, -c[0] / 4 + c[1] / 2 - c[2] / 4};
}

Rgba from_axes(const Axes& a, double alpha, filter::ClipSpace space) {
  if (space == filter::ClipSpace::rgb) return {a[0], a[1], a[2], alpha};
  return {a[0] + a[1] - a[2], a[0] + a[2], a[0] - a[1] - a[2], alpha};
}

}  // namespace

Grid<double> trust(const Grid<Surface>& now, const Grid<Surface>& before, const Grid<Vec2>& offset,
                   const filter::Settings& settings) {
  Grid<double> result(now.width, now.height);
  for (int y = 0; y < now.height; ++y) {
    for (int x = 0; x < now.width; ++x) {
      const double px = x + offset.at(x, y).x;
      const double py = y + offset.at(x, y).y;
      double sum = 0;
      for (int v = static_cast<int>(std::floor(py)); v <= std::floor(py) + 1; ++v) {
        for (int u = static_cast<int>(std::floor(px)); u <= std::floor(px) + 1; ++u) {
          const double weight = (1 - std::abs(px - u)) * (1 - std::abs(py - v));
          sum += weight * pixel_trust(now, x, y, before.clamped(u, v), settings);
        }
      }
      result.at(x, y) = sum;
    }
  }
  return result;
}

Grid<Estimate> rectify(const Grid<Estimate>& sample, const Grid<Estimate>& warped,
                       const filter::Settings& settings) {
  Grid<Estimate> result = warped;
  for (int y = 0; y < sample.height; ++y) {
    for (int x = 0; x < sample.width; ++x) {
      Estimate& out = result.at(x, y);
      std::vector<Axes> colors;
      double noise = 0;
      for (int v = y - settings.clip_radius; v <= y + settings.clip_radius; ++v) {
        for (int u = x - settings.clip_radius; u <= x + settings.clip_radius; ++u) {
          const Estimate& tap = sample.clamped(u, v);
          if (tap.count <= 0) continue;
          colors.push_back(to_axes(tap.color, settings.clip_space));
          noise += tap.variance;
        }
      }
      if (colors.empty() || out.count <= 0) continue;
      const auto count = static_cast<double>(colors.size());
      Axes mean{}, deviation{}, low, high;
      low.fill(std::numeric_limits<double>::infinity());
      high.fill(-std::numeric_limits<double>::infinity());
      for (int c = 0; c < 3; ++c) {
        for (const Axes& color : colors) mean[c] += color[c] / count;
        for (const Axes& color : colors) {
          deviation[c] += (color[c] - mean[c]) * (color[c] - mean[c]) / count;
          low[c] = std::min(low[c], color[c]);
          high[c] = std::max(high[c], color[c]);
        }
        if (settings.history_clip != filter::HistoryClip::variance) continue;
        low[c] = mean[c] - settings.clip_gamma * std::sqrt(deviation[c]);
        high[c] = mean[c] + settings.clip_gamma * std::sqrt(deviation[c]);
      }
      const Axes from = to_axes(out.color, settings.clip_space);
      Axes to = from;
      double way = 0, moved = 0, kept = 1;
      for (int c = 0; c < 3; ++c) {
        to[c] = std::clamp(from[c], low[c], high[c]);
        moved += (to[c] - from[c]) * (to[c] - from[c]);
        way += (from[c] - mean[c]) * (from[c] - mean[c]);
        if (to[c] != from[c]) kept = std::min(kept, (to[c] - mean[c]) / (from[c] - mean[c]));
      }
      if (moved == 0) continue;
      double share = std::sqrt(moved / way);
      if (settings.history_clip != filter::HistoryClip::clamp) {
        share = 1 - kept;
        for (int c = 0; c < 3; ++c) to[c] = mean[c] + kept * (from[c] - mean[c]);
      }
      out.color = from_axes(to, out.color[3], settings.clip_space);
      out.variance = (1 - share) * (1 - share) * out.variance + share * share * noise / (count * count);
      out.count = 1 / ((1 - share) * (1 - share) / out.count + share * share);
    }
  }
  return result;
}

}  // namespace becalm::reference
