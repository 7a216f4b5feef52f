#include "tests/filter/reference/align.h"

#include <array>
#include <limits>

namespace becalm::reference {
namespace {

using filter::Distance;
using Planes = std::vector<Grid<double>>;

Grid<double> downsample(const Grid<double>& fine, int factor) {
  Grid<double> coarse((fine.width + factor - 1) / factor, (fine.height + factor - 1) / factor);
  for (int y = 0; y < coarse.height; ++y) {
    for (int x = 0; x < coarse.width; ++x) {
      double sum = 0.0;
      int count = 0;
      for (int v = y * factor; v < std::min((y + 1) * factor, fine.height); ++v) {
        for (int u = x * factor; u < std::min((x + 1) * factor, fine.width); ++u) {
          sum += fine.at(u, v);
          ++count;
        }
      }
      coarse.at(x, y) = sum / count;
    }
  }
  return coarse;
}

double distance(Distance kind, const std::vector<double>& differences) {
  double sum = 0.0;
  for (const double d : differences) sum += kind == Distance::l2 ? d * d : std::abs(d);
  return kind == Distance::log_l1 || kind == Distance::log_l1_centered ? std::log(2.0 + sum) : sum;
}

double floor_of(Distance kind) {
  return distance(kind, {});
}

double center_weight(Distance kind, int sx, int sy) {
  return kind == Distance::log_l1_centered ? 2.0 - std::exp(-0.02 * (sx * sx + sy * sy)) : 1.0;
}

/// Position of the quadric's minimum; {0,0} if it has none within a pixel. Weighted least squares over the
/// 3x3 costs, with weights (1,2,1)x(1,2,1) as in Hasinoff et al. 2016, by the normal equations of the six
/// monomials.
Vec2 quadric_minimum(const std::array<std::array<double, 3>, 3>& cost) {
  std::array<std::array<double, 7>, 6> equations{};
  for (int y = -1; y <= 1; ++y) {
    for (int x = -1; x <= 1; ++x) {
      const double weight = (x == 0 ? 2 : 1) * (y == 0 ? 2 : 1);
      const std::array<double, 7> row{1,           double(x),     double(y),         x * x / 2.0,
                                      y * y / 2.0, double(x * y), cost[y + 1][x + 1]};
      for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 7; ++j) equations[i][j] += weight * row[i] * row[j];
      }
    }
  }
  for (int pivot = 0; pivot < 6; ++pivot) {
    for (int i = 0; i < 6; ++i) {
      if (i == pivot) continue;
      const double factor = equations[i][pivot] / equations[pivot][pivot];
      for (int j = pivot; j < 7; ++j) equations[i][j] -= factor * equations[pivot][j];
    }
  }
  const auto coefficient = [&](int i) { return equations[i][6] / equations[i][i]; };
  const double bx = coefficient(1), by = coefficient(2);
  // A hundredth of the larger curvature more in every direction takes the nearest point of a valley.
  const double larger = std::max(coefficient(3), coefficient(4));
  const double axx = coefficient(3) + 0.01 * larger, ayy = coefficient(4) + 0.01 * larger,
               axy = coefficient(5);
  const double det = axx * ayy - axy * axy;
  if (larger <= 1e-5 * cost[1][1] || axx <= 0 || ayy <= 0 || det <= 0) return {};
  const Vec2 m{(axy * by - ayy * bx) / det, (axy * bx - axx * by) / det};
  return m.x * m.x + m.y * m.y <= 1.0 ? m : Vec2{};
}

/// Median of each component over 3x3 pixels; doubtful where any of the nine is.
void take_medians(Alignment& level) {
  const Alignment noisy = level;
  for (int y = 0; y < noisy.offset.height; ++y) {
    for (int x = 0; x < noisy.offset.width; ++x) {
      std::array<double, 9> xs{}, ys{};
      for (int k = 0; k < 9; ++k) {
        xs[k] = noisy.offset.clamped(x + k % 3 - 1, y + k / 3 - 1).x;
        ys[k] = noisy.offset.clamped(x + k % 3 - 1, y + k / 3 - 1).y;
        level.ambiguous.at(x, y) |= noisy.ambiguous.clamped(x + k % 3 - 1, y + k / 3 - 1);
      }
      std::ranges::sort(xs);
      std::ranges::sort(ys);
      level.offset.at(x, y) = {xs[4], ys[4]};
    }
  }
}

}  // namespace

Alignment align(const Planes& target_finest, const Planes& source_finest, const filter::Settings& settings,
                std::size_t levels) {
  std::vector<Planes> targets{target_finest};
  std::vector<Planes> sources{source_finest};
  for (std::size_t l = 1; l < levels; ++l) {
    targets.emplace_back();
    sources.emplace_back();
    for (const auto& plane : targets[l - 1]) targets[l].push_back(downsample(plane, settings.pyramid_factor));
    for (const auto& plane : sources[l - 1]) sources[l].push_back(downsample(plane, settings.pyramid_factor));
  }

  Alignment result;
  for (std::size_t l = levels; l-- > 0;) {
    const Planes& target = targets[l];
    const Planes& source = sources[l];
    const int width = target[0].width;
    const int height = target[0].height;
    const int radius = settings.blur_radius[std::min(l, settings.blur_radius.size() - 1)];

    // Where this level starts from, and whether that is certain.
    Grid<Vec2> start(width, height);
    Grid<char> ambiguous(width, height, false);
    if (l + 1 < levels) {
      const int f = settings.pyramid_factor;
      Grid<double> ox(result.offset.width, result.offset.height);
      Grid<double> oy = ox;
      Grid<double> doubt = ox;
      for (std::size_t i = 0; i < ox.data.size(); ++i) {
        ox.data[i] = result.offset.data[i].x;
        oy.data[i] = result.offset.data[i].y;
        doubt.data[i] = result.ambiguous.data[i];
      }
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const double cx = (x + 0.5) / f - 0.5;
          const double cy = (y + 0.5) / f - 0.5;
          start.at(x, y) = {f * bilinear(ox, cx, cy), f * bilinear(oy, cx, cy)};
          ambiguous.at(x, y) = bilinear(doubt, cx, cy) > 0.0;
        }
      }
    }

    std::vector<Grid<double>> pixel(25, Grid<double>(width, height));
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (int k = 0; k < 25; ++k) {
          std::vector<double> differences;
          for (std::size_t c = 0; c < target.size(); ++c) {
            differences.push_back(target[c].at(x, y) - bilinear(source[c], x + start.at(x, y).x + k % 5 - 2,
                                                                y + start.at(x, y).y + k / 5 - 2));
          }
          pixel[k].at(x, y) = distance(settings.distance, differences);
        }
      }
    }

    Alignment level{Grid<Vec2>(width, height), Grid<double>(width, height), ambiguous};
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        std::array<double, 25> mean{};
        std::array<double, 25> cost{};
        int best = 0;
        for (int k = 0; k < 25; ++k) {
          int count = 0;
          for (int v = std::max(y - radius, 0); v <= std::min(y + radius, height - 1); ++v) {
            for (int u = std::max(x - radius, 0); u <= std::min(x + radius, width - 1); ++u) {
              mean[k] += pixel[k].at(u, v);
              ++count;
            }
          }
          mean[k] /= count;
          cost[k] = mean[k] * center_weight(settings.distance, k % 5 - 2, k / 5 - 2);
          const auto motion = [&](int i) {
            return std::hypot(start.at(x, y).x + i % 5 - 2, start.at(x, y).y + i / 5 - 2);
          };
          if (cost[k] < cost[best] || (cost[k] == cost[best] && motion(k) < motion(best))) best = k;
        }
        double second = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 25; ++k) {
          if (k != best) second = std::min(second, cost[k]);
        }
        if (second - cost[best] <= 1e-4 * second) level.ambiguous.at(x, y) = true;

        const int sx = best % 5 - 2;
        const int sy = best / 5 - 2;
        Vec2 subpixel;
        if (static_cast<int>(l) < settings.refine_levels && std::abs(sx) < 2 && std::abs(sy) < 2) {
          std::array<std::array<double, 3>, 3> around{};
          for (int j = -1; j <= 1; ++j) {
            for (int i = -1; i <= 1; ++i) around[j + 1][i + 1] = mean[best + 5 * j + i];
          }
          subpixel = quadric_minimum(around);
          const auto limit = [&](int step) {
            const double least = floor_of(settings.distance);
            const double ratio =
                (mean[best] - least) / std::max(1e-30, (mean[best - step] + mean[best + step]) / 2 - least);
            return std::min(1.0, settings.distance == Distance::l2 ? std::sqrt(ratio) : ratio);
          };
          subpixel = {std::clamp(subpixel.x, -limit(1), limit(1)),
                      std::clamp(subpixel.y, -limit(5), limit(5))};
        }
        level.offset.at(x, y) = {start.at(x, y).x + sx + subpixel.x, start.at(x, y).y + sy + subpixel.y};
        level.residual.at(x, y) = mean[best] - floor_of(settings.distance);
      }
    }
    take_medians(level);
    result = std::move(level);
  }
  return result;
}

}  // namespace becalm::reference
