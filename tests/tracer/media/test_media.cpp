#include "tests/tracer/media/test_media.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace becalm::tracer {

double MeanTest::standard_error() const {
  return std::sqrt(squares_ / (count_ * (count_ - 1.0)));
}

double MeanTest::p_value(double truth) const {
  const double error = standard_error();
  if (error == 0.0) return std::abs(mean_ - truth) <= 1e-6 * std::abs(truth) ? 1.0 : 0.0;
  return std::erfc(std::abs(mean_ - truth) / (error * std::sqrt(2.0)));
}

DensityGrid lumpy_grid() {
  const V3i size(37, 22, 45);
  std::vector<float> values;
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        const double waves = std::sin(0.41 * x) * std::sin(0.53 * y + 0.4) * std::sin(0.37 * z + 1.0);
        const bool border =
            x == 0 || y == 0 || z == 0 || x == size.x - 1 || y == size.y - 1 || z == size.z - 1;
        values.push_back(border ? 0.0f : static_cast<float>(std::clamp(2.0 * waves - 0.5, 0.0, 1.0)));
      }
    }
  }
  // A block in the middle that is empty whatever the waves.
  for (int z = 16; z <= 24; ++z) {
    for (int y = 8; y <= 16; ++y) {
      for (int x = 16; x <= 24; ++x) values[(static_cast<std::size_t>(z) * size.y + y) * size.x + x] = 0.0f;
    }
  }
  return {size, std::move(values)};
}

GridMedium place(DensityGrid grid, const M44d& medium_to_world, float extinction) {
  const V3i size = grid.size();
  GridMedium medium;
  medium.density = std::make_shared<const DensityGrid>(std::move(grid));
  medium.world_to_voxels = world_to_voxels(medium_to_world, size);
  medium.extinction = extinction;
  medium.albedo = V3f(0.9f, 0.5f, 0.0f);
  return medium;
}

M44d oblique_place() {
  M44d place;
  place.translate(Imath::V3d(4.0, -2.0, 7.0));
  place.rotate(Imath::V3d(0.4, -0.9, 1.3));
  place.scale(Imath::V3d(3.0, 0.8, 2.0));
  return place;
}

namespace {

double trilinear(const DensityGrid& grid, const V3d& p) {
  int cell[3];
  double f[3];
  for (int a = 0; a < 3; ++a) {
    if (p[a] < 0.0 || p[a] > grid.size()[a] - 1) return 0.0;
    cell[a] = std::min(static_cast<int>(p[a]), grid.size()[a] - 2);
    f[a] = p[a] - cell[a];
  }
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    sum += (x ? f[0] : 1 - f[0]) * (y ? f[1] : 1 - f[1]) * (z ? f[2] : 1 - f[2]) *
           grid.value(cell[0] + x, cell[1] + y, cell[2] + z);
  }
  return sum;
}

}  // namespace

std::vector<double> optical_depths(const GridMedium& medium, const TestRay& ray,
                                   const std::vector<double>& distances) {
  const M44d to_voxels(medium.world_to_voxels);
  const V3d origin = transform_point(V3d(ray.origin), to_voxels);
  const V3d dir = transform_vector(V3d(ray.dir), to_voxels);
  std::vector<double> crossings = {0.0};
  for (int a = 0; a < 3; ++a) {
    if (dir[a] == 0.0) continue;
    for (int plane = 0; plane < medium.density->size()[a]; ++plane) {
      crossings.push_back((plane - origin[a]) / dir[a]);
    }
  }
  crossings.insert(crossings.end(), distances.begin(), distances.end());
  std::sort(crossings.begin(), crossings.end());

  std::vector<double> depths;
  double depth = 0.0;
  auto from = std::lower_bound(crossings.begin(), crossings.end(), 0.0);
  for (const double distance : distances) {
    for (; *from < distance; ++from) {
      const double middle = 0.5 * (from[0] + from[1]);
      const double half = 0.5 * (from[1] - from[0]);
      for (const double node : {-1.0, 1.0}) {
        depth += half * trilinear(*medium.density, origin + dir * (middle + node * half / std::sqrt(3.0)));
      }
    }
    depths.push_back(depth * medium.extinction);
  }
  return depths;
}

}  // namespace becalm::tracer
