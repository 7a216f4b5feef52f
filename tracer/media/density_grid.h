#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "tracer/math/vec.h"

namespace becalm::tracer {

using Imath::V3i;

/// A density in [0, largest float] on the box [0, size - 1] of voxel coordinates, in which value (i,j,k) lies
/// at the point (i,j,k): DEFINED as the trilinear interpolation of the eight values around a point, and as 0
/// outside. Blocks of 8^3 cells know the largest value at their corners, which therefore bounds the density
/// in them exactly.
class DensityGrid {
 public:
  static constexpr int kBlockCells = 8;

  DensityGrid() = default;

  /// `values` x fastest, then y, then z; at least 2 on every axis.
  DensityGrid(const V3i& size, std::vector<float> values);

  const V3i& size() const { return size_; }
  const V3i& blocks() const { return blocks_; }
  float value(int x, int y, int z) const { return values_[index(x, y, z)]; }
  float largest() const { return largest_; }
  std::size_t bytes() const { return (values_.capacity() + majorants_.capacity()) * sizeof(float); }

  /// No density in the block, its faces included, exceeds this.
  float majorant(const V3i& block) const {
    return majorants_[(static_cast<std::size_t>(block.z) * blocks_.y + block.y) * blocks_.x + block.x];
  }

  /// The density at a point of the block; a point that rounding put beside the block counts as the nearest
  /// one of it, so that the majorant holds.
  float density_in_block(const V3i& block, const V3f& p) const {
    int cell[3];
    float f[3];
    for (int a = 0; a < 3; ++a) {
      const int first = block[a] * kBlockCells;
      const int last = std::min(first + kBlockCells, size_[a] - 1);
      const float in_block = std::clamp(p[a], static_cast<float>(first), static_cast<float>(last));
      cell[a] = std::min(static_cast<int>(in_block), last - 1);
      f[a] = in_block - static_cast<float>(cell[a]);
    }
    const float* corner = &values_[index(cell[0], cell[1], cell[2])];
    const std::size_t y = static_cast<std::size_t>(size_.x);
    const std::size_t z = y * size_.y;
    const float low = lerp(lerp(corner[0], corner[1], f[0]), lerp(corner[y], corner[y + 1], f[0]), f[1]);
    corner += z;
    const float high = lerp(lerp(corner[0], corner[1], f[0]), lerp(corner[y], corner[y + 1], f[0]), f[1]);
    return lerp(low, high, f[2]);
  }

 private:
  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * size_.y + y) * size_.x + x;
  }
  static float lerp(float a, float b, float f) { return (1.0f - f) * a + f * b; }

  V3i size_{0};
  V3i blocks_{0};
  std::vector<float> values_;
  std::vector<float> majorants_;
  float largest_ = 0.0f;
};

/// Part of a ray origin + t dir in voxel coordinates.
struct GridSpan {
  V3f origin;  ///< the point at t = 0, which lies in the box or within rounding of it
  V3f dir;
  float length;  ///< to where the ray leaves the box, or to its own end; 0 if it never is in the box
  float offset;  ///< t of `origin` on the ray that was clipped
};

/// The part of the ray's [0, t_max] that is in the box. Coordinates that are not finite are outside.
GridSpan clip_to_grid(const DensityGrid& grid, const V3f& origin, const V3f& dir, float t_max);

/// Calls visit(block, majorant, t_in, t_out) for the blocks that hold density along the span, in order, until
/// it returns false. Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987; distances
/// to faces are computed anew for each face, so that no error builds up. Ends after at most the sum of the
/// three numbers of blocks, since every step goes on by one block along one axis and never back.
template <class Visit>
void visit_blocks(const DensityGrid& grid, const GridSpan& span, const Visit& visit) {
  if (!(span.length > 0.0f)) return;
  // Plain arrays: an axis is an index here, which Imath's vectors would put through memory as a whole.
  float origin[3], dir_inverse[3], t_face[3];
  int block[3], step[3], end[3], face[3];
  for (int a = 0; a < 3; ++a) {
    // A ray that is parallel to faces, but for rounding, crosses none of them.
    const bool parallel = std::abs(span.dir[a]) < 1e-30f;
    step[a] = span.dir[a] < 0.0f ? -1 : 1;
    end[a] = step[a] < 0 ? -1 : grid.blocks()[a];
    origin[a] = span.origin[a];
    dir_inverse[a] = parallel ? 0.0f : 1.0f / span.dir[a];
    block[a] = std::clamp(static_cast<int>(origin[a] / DensityGrid::kBlockCells), 0, grid.blocks()[a] - 1);
    face[a] = (block[a] + (step[a] > 0 ? 1 : 0)) * DensityGrid::kBlockCells;
    t_face[a] = parallel ? std::numeric_limits<float>::infinity()
                         : (static_cast<float>(face[a]) - origin[a]) * dir_inverse[a];
  }
  float t_in = 0.0f;
  while (t_in < span.length) {
    const int first = t_face[0] <= t_face[1] ? 0 : 1;
    const int axis = t_face[first] <= t_face[2] ? first : 2;
    const float t_out = std::min(t_face[axis], span.length);
    const V3i at(block[0], block[1], block[2]);
    const float majorant = grid.majorant(at);
    if (majorant > 0.0f && t_out > t_in && !visit(at, majorant, t_in, t_out)) return;
    t_in = std::max(t_in, t_out);
    block[axis] += step[axis];
    if (block[axis] == end[axis]) return;
    face[axis] += step[axis] * DensityGrid::kBlockCells;
    t_face[axis] = (static_cast<float>(face[axis]) - origin[axis]) * dir_inverse[axis];
  }
}

}  // namespace becalm::tracer
