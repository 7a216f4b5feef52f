#include "tracer/media/density_grid.h"

#include <tbb/parallel_for.h>

#include <cassert>

namespace becalm::tracer {

namespace {

/// The interpolation's rounding: products and sums of weights that add up to 1.
constexpr float kRoundingAllowance = 1.0f + 0x1p-20f;

}  // namespace

DensityGrid::DensityGrid(const V3i& size, std::vector<float> values)
    : size_(size), values_(std::move(values)) {
  assert(size.x >= 2 && size.y >= 2 && size.z >= 2);
  assert(values_.size() == static_cast<std::size_t>(size.x) * size.y * size.z);
  for (int a = 0; a < 3; ++a) blocks_[a] = (size[a] - 1 + kBlockCells - 1) / kBlockCells;
  majorants_.resize(static_cast<std::size_t>(blocks_.x) * blocks_.y * blocks_.z);
  tbb::parallel_for(0, blocks_.z, [&](int bz) {
    std::size_t entry = static_cast<std::size_t>(bz) * blocks_.y * blocks_.x;
    for (int by = 0; by < blocks_.y; ++by) {
      for (int bx = 0; bx < blocks_.x; ++bx) {
        // Both faces of the block are read, and so are those that it shares with its neighbours.
        float largest = 0.0f;
        for (int z = bz * kBlockCells; z <= std::min((bz + 1) * kBlockCells, size_.z - 1); ++z) {
          for (int y = by * kBlockCells; y <= std::min((by + 1) * kBlockCells, size_.y - 1); ++y) {
            for (int x = bx * kBlockCells; x <= std::min((bx + 1) * kBlockCells, size_.x - 1); ++x) {
              largest = std::max(largest, value(x, y, z));
            }
          }
        }
        majorants_[entry++] = largest * kRoundingAllowance;
      }
    }
  });
  for (const float majorant : majorants_) largest_ = std::max(largest_, majorant);
}

GridSpan clip_to_grid(const DensityGrid& grid, const V3f& origin, const V3f& dir, float t_max) {
  float t_in = 0.0f;
  float t_out = t_max;
  bool inside = is_finite(origin) && is_finite(dir);
  for (int a = 0; a < 3; ++a) {
    const float high = static_cast<float>(grid.size()[a] - 1);
    if (dir[a] == 0.0f) {
      inside = inside && origin[a] >= 0.0f && origin[a] <= high;
      continue;
    }
    const float t_low = -origin[a] / dir[a];
    const float t_high = (high - origin[a]) / dir[a];
    t_in = std::max(t_in, std::min(t_low, t_high));
    t_out = std::min(t_out, std::max(t_low, t_high));
  }
  if (!inside || !(t_in < t_out)) return {origin, dir, 0.0f, 0.0f};
  return {origin + dir * t_in, dir, t_out - t_in, t_in};
}

}  // namespace becalm::tracer
