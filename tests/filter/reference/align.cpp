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

constexpr double kMotionPenalty = 1e-5;

/// The kernels' logarithmic costs have base 2.
double cost_unit(Distance kind) {
  return kind == Distance::log_l1 || kind == Distance::log_l1_centered ? std::log(2.0) : 1.0;
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
  // Adding a hundredth of the larger curvature in every direction selects the nearest point of a valley.
  const double larger = std::max(coefficient(3), coefficient(4));
  const double axx = coefficient(3) + 0.01 * larger, ayy = coefficient(4) + 0.01 * larger,
               axy = coefficient(5);
  const double det = axx * ayy - axy * axy;
  if (larger <= 1e-5 * cost[1][1] || axx <= 0 || ayy <= 0 || det <= 0) return {};
  const Vec2 m{(axy * by - ayy * bx) / det, (axy * bx - axx * by) / det};
  return m.x * m.x + m.y * m.y <= 1.0 ? m : Vec2{};
}

/// A level's start offsets: the coarser level's, read bilinearly; zero if `factor` is 0.
class Start {
 public:
  Start(const Alignment& coarse, int factor)
      : factor_(factor), x_(coarse.offset.width, coarse.offset.height), y_(x_), doubt_(x_) {
    for (std::size_t i = 0; i < x_.data.size(); ++i) {
      x_.data[i] = coarse.offset.data[i].x;
      y_.data[i] = coarse.offset.data[i].y;
      doubt_.data[i] = coarse.ambiguous.data[i];
    }
  }
  Vec2 offset(double x, double y) const {
    if (factor_ == 0) return {};
    return {factor_ * bilinear(x_, coarse(x), coarse(y)), factor_ * bilinear(y_, coarse(x), coarse(y))};
  }
  bool is_ambiguous(double x, double y) const {
    return factor_ > 0 && bilinear(doubt_, coarse(x), coarse(y)) > 0.0;
  }

 private:
  double coarse(double position) const { return (position + 0.5) / factor_ - 0.5; }

  int factor_;
  Grid<double> x_, y_, doubt_;
};

/// Median of each component over 3x3 pixels; ambiguous if any of the nine is.
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
    for (const auto& plane : targets[l - 1]) targets[l].push_back(downsample(plane, settings.pyramid.factor));
    for (const auto& plane : sources[l - 1]) sources[l].push_back(downsample(plane, settings.pyramid.factor));
  }

  Alignment result;
  for (std::size_t l = levels; l-- > 0;) {
    const Planes& target = targets[l];
    const Planes& source = sources[l];
    const int width = target[0].width;
    const int height = target[0].height;
    const int radius = settings.blur_radius[std::min(l, settings.blur_radius.size() - 1)];

    // The source, warped to the target's pixels by the start offsets.
    const Start start(result, l + 1 < levels ? settings.pyramid.factor : 0);
    std::vector<Grid<double>> warped;
    Grid<char> ambiguous(width, height, false);
    for (const Grid<double>& plane : source) {
      warped.emplace_back(width, height);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          const Vec2 offset = start.offset(x, y);
          warped.back().at(x, y) = bilinear(plane, x + offset.x, y + offset.y);
          ambiguous.at(x, y) = start.is_ambiguous(x, y);
        }
      }
    }

    std::vector<Grid<double>> pixel(25, Grid<double>(width, height));
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (int k = 0; k < 25; ++k) {
          std::vector<double> differences;
          for (std::size_t c = 0; c < target.size(); ++c) {
            differences.push_back(target[c].at(x, y) - warped[c].clamped(x + k % 5 - 2, y + k / 5 - 2));
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
          const int sx = k % 5 - 2, sy = k / 5 - 2;
          const Vec2 from = start.offset(x, y);
          // The penalty of motion, to second order as in shaders/lib/choice.glsl.
          const double motion =
              (from.x * sx + from.y * sy + 0.5 * (sx * sx + sy * sy)) / (1.0 + std::hypot(from.x, from.y));
          cost[k] = mean[k] * center_weight(settings.distance, sx, sy) +
                    kMotionPenalty * cost_unit(settings.distance) * motion;
          if (cost[k] < cost[best]) best = k;
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
        // The warped source at the matched position was read at that position's start offset.
        const Vec2 shift{sx + subpixel.x, sy + subpixel.y};
        const double matched_x = std::clamp(x + shift.x, 0.0, width - 1.0);
        const double matched_y = std::clamp(y + shift.y, 0.0, height - 1.0);
        const Vec2 from = start.offset(matched_x, matched_y);
        level.offset.at(x, y) = {shift.x + from.x, shift.y + from.y};
        if (start.is_ambiguous(matched_x, matched_y)) level.ambiguous.at(x, y) = true;
        level.residual.at(x, y) = mean[best] - floor_of(settings.distance);
      }
    }
    take_medians(level);
    result = std::move(level);
  }
  return result;
}

}  // namespace becalm::reference
