#include "tests/tracer/shading/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <numbers>
#include <utility>

namespace becalm::tracer {
namespace {

constexpr std::array<double, 4> kNode = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                         0.8611363115940526};
constexpr std::array<double, 4> kWeight = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                           0.3478548451374538};

double gauss(const std::function<double(const V2d&)>& function, const Cell& cell) {
  double sum = 0.0;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      const double x = 0.5 * (cell.x0 + cell.x1 + kNode[i] * (cell.x1 - cell.x0));
      const double y = 0.5 * (cell.y0 + cell.y1 + kNode[j] * (cell.y1 - cell.y0));
      sum += kWeight[i] * kWeight[j] * function({x, y});
    }
  }
  return 0.25 * sum * cell.area();
}

std::pair<Cell, Cell> halves(const Cell& cell, bool along_x, double at) {
  Cell low = cell;
  Cell high = cell;
  if (along_x) {
    low.x1 = high.x0 = at;
  } else {
    low.y1 = high.y0 = at;
  }
  return {low, high};
}

double refine(const std::function<double(const V2d&)>& function, const Cell& cell, double whole,
              double tolerance, int depth) {
  const double mid_x = 0.5 * (cell.x0 + cell.x1);
  const double mid_y = 0.5 * (cell.y0 + cell.y1);
  const auto [left, right] = halves(cell, true, mid_x);
  const auto [left_low, left_high] = halves(left, false, mid_y);
  const auto [right_low, right_high] = halves(right, false, mid_y);
  const std::array<Cell, 4> quarters = {left_low, left_high, right_low, right_high};
  std::array<double, 4> parts;
  double sum = 0.0;
  for (int q = 0; q < 4; ++q) sum += parts[q] = gauss(function, quarters[q]);
  if (depth == 0 || std::abs(sum - whole) <= tolerance) return sum;
  sum = 0.0;
  for (int q = 0; q < 4; ++q) sum += refine(function, quarters[q], parts[q], 0.25 * tolerance, depth - 1);
  return sum;
}

/// A cell of the partition, and the box of the pilot samples in it.
struct Leaf {
  Cell cell;
  Cell points;
};

Cell bounding_box(std::vector<V2d>::iterator begin, std::vector<V2d>::iterator end) {
  Cell box = {begin->x, begin->x, begin->y, begin->y};
  for (auto point = begin; point != end; ++point) {
    box = {std::min(box.x0, point->x), std::max(box.x1, point->x), std::min(box.y0, point->y),
           std::max(box.y1, point->y)};
  }
  return box;
}

/// Cuts a cell at the median of the points in it, across the direction in which they spread further, until
/// `count` cells are left or the points are used up.
void cut(const Cell& cell, std::vector<V2d>::iterator begin, std::vector<V2d>::iterator end, int count,
         std::vector<Leaf>& leaves) {
  const Cell box = begin == end ? cell : bounding_box(begin, end);
  const bool along_x = box.x1 - box.x0 > box.y1 - box.y0;
  const auto median = begin + (end - begin) / 2;
  if (count > 1 && end - begin >= 4) {
    std::nth_element(begin, median, end,
                     [&](const V2d& a, const V2d& b) { return along_x ? a.x < b.x : a.y < b.y; });
    const auto [below, above] = halves(cell, along_x, along_x ? median->x : median->y);
    if (below.area() > 0.0 && above.area() > 0.0) {
      cut(below, begin, median, count / 2, leaves);
      cut(above, median, end, count - count / 2, leaves);
      return;
    }
  }
  leaves.push_back({cell, box});
}

/// Integral over the leaf's cell, cut at the box of its points: a narrow lobe in a wide cell is not
/// overlooked.
double integrate_leaf(const std::function<double(const V2d&)>& function, const Leaf& leaf) {
  const double margin_x = 0.1 * (leaf.points.x1 - leaf.points.x0);
  const double margin_y = 0.1 * (leaf.points.y1 - leaf.points.y0);
  const std::array<double, 4> x = {leaf.cell.x0, std::max(leaf.cell.x0, leaf.points.x0 - margin_x),
                                   std::min(leaf.cell.x1, leaf.points.x1 + margin_x), leaf.cell.x1};
  const std::array<double, 4> y = {leaf.cell.y0, std::max(leaf.cell.y0, leaf.points.y0 - margin_y),
                                   std::min(leaf.cell.y1, leaf.points.y1 + margin_y), leaf.cell.y1};
  double sum = 0.0;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const Cell part = {x[i], x[i + 1], y[j], y[j + 1]};
      if (part.area() > 0.0) sum += integrate(function, part);
    }
  }
  return sum;
}

bool contains(const Cell& cell, const V2d& p, const Cell& domain) {
  return p.x >= cell.x0 && (p.x < cell.x1 || cell.x1 == domain.x1) && p.y >= cell.y0 &&
         (p.y < cell.y1 || cell.y1 == domain.y1);
}

std::vector<Cell> split_at_jumps(const Chart& chart) {
  std::vector<Cell> cells = {chart.domain};
  for (const bool along_x : {true, false}) {
    for (const double at : along_x ? chart.jumps_x : chart.jumps_y) {
      std::vector<Cell> next;
      for (const Cell& cell : cells) {
        const bool inside = along_x ? cell.x0 < at && at < cell.x1 : cell.y0 < at && at < cell.y1;
        if (!inside) {
          next.push_back(cell);
          continue;
        }
        const auto [low, high] = halves(cell, along_x, at);
        next.insert(next.end(), {low, high});
      }
      cells = std::move(next);
    }
  }
  return cells;
}

}  // namespace

double chi_square_p_value(double statistic, int degrees_of_freedom) {
  return cdf(complement(boost::math::chi_squared(degrees_of_freedom), statistic));
}

double sidak_level(double suite_level, int tests) {
  return 1.0 - std::pow(1.0 - suite_level, 1.0 / tests);
}

ChiSquare chi_square(const std::vector<double>& observed, const std::vector<double>& expected) {
  double statistic = 0.0;
  double pooled_observed = 0.0;
  double pooled_expected = 0.0;
  int cells = 0;
  const auto add = [&](double o, double e) {
    statistic += (o - e) * (o - e) / e;
    ++cells;
  };
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] >= 5.0) {
      add(observed[i], expected[i]);
    } else {
      pooled_observed += observed[i];
      pooled_expected += expected[i];
    }
  }
  // What is expected hardly ever and seen often must not vanish in the pool.
  if (pooled_expected >= 5.0 || pooled_observed > 20.0) add(pooled_observed, std::max(pooled_expected, 1e-3));
  const int degrees_of_freedom = std::max(1, cells - 1);
  return {chi_square_p_value(statistic, degrees_of_freedom), statistic, degrees_of_freedom};
}

Chart sphere_chart(std::function<std::optional<V3f>(TestRandom&)> draw,
                   std::function<float(const V3f&)> pdf) {
  Chart chart;
  chart.domain = {-std::numbers::pi, std::numbers::pi, 0.0, std::numbers::pi};
  chart.draw = [draw = std::move(draw)](TestRandom& random) -> std::optional<V2d> {
    const std::optional<V3f> direction = draw(random);
    if (!direction) return std::nullopt;
    const V3d w(*direction);
    return V2d(std::atan2(w.y, w.x), std::atan2(std::hypot(w.x, w.y), w.z));
  };
  chart.density = [pdf = std::move(pdf)](const V2d& p) {
    const double sin_theta = std::sin(p.y);
    const V3d w(std::cos(p.x) * sin_theta, std::sin(p.x) * sin_theta, std::cos(p.y));
    return pdf(V3f(w)) * sin_theta;
  };
  chart.jumps_y = {0.5 * std::numbers::pi};
  return chart;
}

double integrate(const std::function<double(const V2d&)>& function, const Cell& cell,
                 double relative_tolerance) {
  // Starting from 4x4 cells keeps a peak between the nodes from being overlooked.
  double estimate = 0.0;
  std::vector<std::pair<Cell, double>> parts;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      const double width = 0.25 * (cell.x1 - cell.x0);
      const double height = 0.25 * (cell.y1 - cell.y0);
      const Cell part = {cell.x0 + i * width, cell.x0 + (i + 1) * width, cell.y0 + j * height,
                         cell.y0 + (j + 1) * height};
      parts.emplace_back(part, gauss(function, part));
      estimate += parts.back().second;
    }
  }
  double sum = 0.0;
  for (const auto& [part, value] : parts) {
    sum += refine(function, part, value, relative_tolerance * std::max(std::abs(estimate), 1e-9) / 16.0, 6);
  }
  return sum;
}

SamplerTest test_sampler(const Chart& chart, std::uint32_t seed, int samples, int cells) {
  TestRandom pilot_random(seed ^ 0x80000000u);
  std::vector<V2d> pilot;
  for (int i = 0; i < 64 * cells; ++i) {
    if (const std::optional<V2d> point = chart.draw(pilot_random)) pilot.push_back(*point);
  }
  std::vector<Leaf> partition;
  for (const Cell& region : split_at_jumps(chart)) {
    const auto end = std::partition(pilot.begin(), pilot.end(),
                                    [&](const V2d& p) { return contains(region, p, chart.domain); });
    const auto share = static_cast<double>(end - pilot.begin()) / std::max<std::size_t>(pilot.size(), 1);
    // Few samples may still be all that a narrow lobe gets, so that no region has less than 16 cells.
    cut(region, pilot.begin(), end, std::max(16, static_cast<int>(std::lround(share * cells))), partition);
  }

  std::vector<double> expected;
  double integral = 0.0;
  for (const Leaf& leaf : partition) {
    const double share = integrate_leaf(chart.density, leaf);
    expected.push_back(share * samples);
    integral += share;
  }
  expected.push_back(std::max(0.0, 1.0 - integral) * samples);

  TestRandom random(seed);
  std::vector<double> observed(partition.size() + 1, 0.0);
  for (int i = 0; i < samples; ++i) {
    std::size_t index = partition.size();
    if (const std::optional<V2d> point = chart.draw(random)) {
      const auto found = std::find_if(partition.begin(), partition.end(), [&](const Leaf& leaf) {
        return contains(leaf.cell, *point, chart.domain);
      });
      index = static_cast<std::size_t>(found - partition.begin());
    }
    observed[index] += 1.0;
  }
  const ChiSquare result = chi_square(observed, expected);

  std::size_t worst = 0;
  const auto misfit = [&](std::size_t i) {
    const double difference = observed[i] - expected[i];
    return difference * difference / std::max(expected[i], 5.0);
  };
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (misfit(i) > misfit(worst)) worst = i;
  }
  std::string where = "samples that found nothing";
  if (worst < partition.size()) {
    const Cell& cell = partition[worst].cell;
    where = fmt::format("cell [{:.6g}, {:.6g}] x [{:.6g}, {:.6g}]", cell.x0, cell.x1, cell.y0, cell.y1);
  }
  return {result, integral,
          fmt::format(
              "seed {} samples {} cells {}: p-value {:.3g} (chi^2 {:.1f}, {} degrees of freedom), density "
              "integrates to {:.6f}; worst: {} expects {:.1f} and holds {}",
              seed, samples, cells, result.p_value, result.statistic, result.degrees_of_freedom, integral,
              where, expected[worst], observed[worst])};
}

}  // namespace becalm::tracer
