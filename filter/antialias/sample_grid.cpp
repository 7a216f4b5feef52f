#include "filter/antialias/sample_grid.h"

#include <algorithm>
#include <cmath>

namespace becalm::filter {
namespace {

double weight_along_axis(const FrameJitter& jitter, double distance_px) {
  // A narrower filter would leave pixels without samples, and one of radius 1.5 is all that 3x3 pixels hold.
  const double radius = std::clamp(static_cast<double>(jitter.radius_px), 0.5, 1.5);
  const double t = std::abs(distance_px) / radius;
  if (t > 1.0) return 0.0;
  switch (jitter.filter) {
    case FilterShape::blackman_harris:
      return blackman_harris_window(t);
    case FilterShape::box:
      return 1.0;
    case FilterShape::tent:
      return 1.0 - t;
  }
  return 0.0;
}

/// The sum of the weights of samples that stand one pixel apart, on average.
double mean_sum(const FrameJitter& jitter) {
  const double width = 2.0 * std::clamp(static_cast<double>(jitter.radius_px), 0.5, 1.5);
  switch (jitter.filter) {
    case FilterShape::blackman_harris:
      return width * kBlackmanHarrisMean;
    case FilterShape::box:
      return width;
    case FilterShape::tent:
      return 0.5 * width;
  }
  return 1.0;
}

/// Radius in input pixels of the filter that finds samples everywhere: that of a bilinear read, or one that
/// reaches the direct neighbours of a pixel without a sample.
double wide_radius(bool is_checkerboard) {
  return is_checkerboard ? 1.5 : 1.0;
}

}  // namespace

SampleGrid sample_grid(const std::optional<FrameJitter>& jitter) {
  SampleGrid grid;
  if (!jitter || jitter->positions_px.size() != 1) return grid;
  const Imath::V2f position = jitter->positions_px.front();
  grid.shift = {-static_cast<int>(std::round(position.x)), -static_cast<int>(std::round(position.y))};
  const double x = position.x + grid.shift.x;
  const double y = position.y + grid.shift.y;
  for (int k = 0; k < 9; ++k) {
    const int column = k % 3 - 1;
    const int row = k / 3 - 1;
    grid.weights[static_cast<std::size_t>(k)] =
        static_cast<float>(weight_along_axis(*jitter, x + column) * weight_along_axis(*jitter, y + row));
  }
  grid.weights[9] = 1.0f;
  return grid;
}

SparseGrid sparse_grid(const std::optional<FrameJitter>& jitter, const Scale& scale,
                       const Imath::Box2i& window, bool is_checkerboard) {
  SparseGrid grid;
  const bool is_known = jitter && !jitter->positions_px.empty();
  if (is_known) {
    for (const Imath::V2f& position : jitter->positions_px) grid.position_px += position;
    grid.position_px /= static_cast<float>(jitter->positions_px.size());
  }
  const double radius = wide_radius(is_checkerboard);
  // A pixel's samples are known by their mean alone, which has their filters' mean.
  const auto narrow_weight = [&](double distance, int axis) {
    double sum = 0.0;
    for (const Imath::V2f& position : jitter->positions_px) {
      const double from_mean = position[axis] - grid.position_px[axis];
      sum += weight_along_axis(*jitter, (distance + from_mean) * scale.value());
    }
    return sum / (mean_sum(*jitter) * static_cast<double>(jitter->positions_px.size()));
  };
  const auto table = [&](int axis) {
    const int first = scale.edge(window.min[axis]);
    const int size = scale.edge(window.max[axis] + 1) - first;
    const NearestSample samples{.scale = scale, .window = window};
    std::vector<float> values(8 * static_cast<std::size_t>(size));
    for (int i = 0; i < size; ++i) {
      const double place = samples.place(i, axis) - grid.position_px[axis];
      const double nearest = std::round(place);
      float* const narrow = &values[4 * static_cast<std::size_t>(i)];
      float* const wide = narrow + 4 * static_cast<std::size_t>(size);
      narrow[0] = static_cast<float>(nearest);
      for (int k = 1; k <= 3; ++k) {
        const double distance = nearest + k - 2 - place;
        wide[k] =
            static_cast<float>(std::max(1.0 - std::abs(distance) / radius, 0.0) / (radius * scale.value()));
        narrow[k] = is_known         ? static_cast<float>(narrow_weight(distance, axis))
                    : scale.is_one() ? (k == 2 ? 1.0f : 0.0f)
                                     : wide[k];
      }
    }
    return values;
  };
  grid.columns = table(0);
  grid.rows = table(1);
  return grid;
}

}  // namespace becalm::filter
