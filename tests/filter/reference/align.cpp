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

/// Position of the quadric's minimum; {0,0} if it has none within a pixel. Least squares over the 3x3 costs
/// by the normal equations of the six monomials, which on this grid are orthogonal but for 1, x^2 and y^2.
Vec2 quadric_minimum(const std::array<std::array<double, 3>, 3>& cost) {
  double s = 0, sx = 0, sy = 0, sxy = 0, sxx = 0, syy = 0;
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      const double c = cost[j + 1][i + 1];
      s += c;
      sx += i * c;
      sy += j * c;
      sxy += i * j * c;
      sxx += i * i * c;
      syy += j * j * c;
    }
  }
  // f = c + bx x + by y + (axx x^2 + ayy y^2)/2 + axy x y
  const double bx = sx / 6, by = sy / 6, axy = sxy / 4;
  const double axx = sxx - 2 * s / 3, ayy = syy - 2 * s / 3;
  const double det = axx * ayy - axy * axy;
  if (axx <= 0 || ayy <= 0 || det <= 1e-3 * axx * ayy) return {};
  const Vec2 m{(axy * by - ayy * bx) / det, (axy * bx - axx * by) / det};
  return m.x * m.x + m.y * m.y <= 1.0 ? m : Vec2{};
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
            for (int i = -1; i <= 1; ++i) around[j + 1][i + 1] = cost[best + 5 * j + i];
          }
          subpixel = quadric_minimum(around);
        }
        level.offset.at(x, y) = {start.at(x, y).x + sx + subpixel.x, start.at(x, y).y + sy + subpixel.y};
        level.residual.at(x, y) = mean[best] - floor_of(settings.distance);
      }
    }
    result = std::move(level);
  }
  return result;
}

}  // namespace becalm::reference
