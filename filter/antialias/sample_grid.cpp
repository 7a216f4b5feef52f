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

}  // namespace

SampleGrid sample_grid(const std::optional<FrameJitter>& jitter) {
  SampleGrid grid;
  if (!jitter || jitter->positions_px.size() != 1) return grid;
  const Imath::V2f position = jitter->positions_px.front();
  grid.shift = {-static_cast<int>(std::round(position.x)), -static_cast<int>(std::round(position.y))};
  const double x = position.x + grid.shift.x;
  const double y = position.y + grid.shift.y;
  for (int k = 0; k < 9; ++k) {
    grid.weights[static_cast<std::size_t>(k)] = static_cast<float>(weight_along_axis(*jitter, x + k % 3 - 1) *
                                                                   weight_along_axis(*jitter, y + k / 3 - 1));
  }
  grid.weights[9] = 1.0f;
  return grid;
}

}  // namespace becalm::filter
