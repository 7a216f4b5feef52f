#pragma once

#include <algorithm>
#include <optional>

#include "tracer/procedural/first_root.h"
#include "tracer/procedural/height_pyramid.h"
#include "tracer/procedural/unit_ray.h"

namespace becalm::tracer {

/// Distance from a height field below which a point counts as on it: what floats lose in coordinates up to 1
/// and heights up to `highest`.
inline float height_tolerance(float highest) {
  return 0x1p-21f * std::max(1.0f, highest);
}

/// The t of the first crossing of a height field over the unit square (x, z in [0,1]), whose heights are
/// `scale` times the pyramid's. `leaf(i, j, t, t_exit, side)` looks for it in a cell of level 0 between t and
/// t_exit: it moves t there and returns true, or returns false.
///
/// Walks the cells along the ray and goes up a level at each parent's border, as Tevs, Ihrke and Seidel,
/// "Maximum mipmaps for fast, accurate, and scalable dynamic height field rendering", 2008. Cells whose range
/// the ray does not meet are passed as a whole. The side on which the ray runs is carried from cell to cell:
/// a crossing that rounding hides between two cells is seen as a change of side.
template <class Leaf>
std::optional<float> trace_heights(const HeightPyramid& pyramid, const UnitRay& ray, float scale,
                                   float tolerance, const Leaf& leaf) {
  // A tiny slope instead of 0 keeps every product finite.
  const auto slanted = [](float d) { return std::abs(d) < 1e-18f ? 1e-18f : d; };
  const float dx = slanted(ray.dir.x), dz = slanted(ray.dir.z);
  const float per_dx = 1.0f / dx, per_dz = 1.0f / dz;
  const int step_x = dx > 0.0f ? 1 : -1, step_z = dz > 0.0f ? 1 : -1;
  const int ahead_x = dx > 0.0f ? 1 : 0, ahead_z = dz > 0.0f ? 1 : 0;
  const float per_resolution = 1.0f / static_cast<float>(pyramid.resolution());
  // When the ray meets the plane at that multiple of a level-0 cell. The same plane gives the same bits for
  // all cells beside it, so that their intervals join.
  const auto plane_x = [&](int i) {
    return (static_cast<float>(i) * per_resolution - ray.origin.x) * per_dx;
  };
  const auto plane_z = [&](int j) {
    return (static_cast<float>(j) * per_resolution - ray.origin.z) * per_dz;
  };

  int level = pyramid.last_level(), i = 0, j = 0;
  float t = 0.0f;
  Side side = Side::unknown;
  for (;;) {
    const float exit_x = plane_x((i + ahead_x) << level), exit_z = plane_z((j + ahead_z) << level);
    const float t_exit = std::max(t, std::min({exit_x, exit_z, ray.t_end}));
    bool descend = true;
    if (level >= pyramid.first_level()) {
      const HeightRange range = pyramid.at(level, i, j);
      const float y0 = ray.origin.y + t * ray.dir.y, y1 = ray.origin.y + t_exit * ray.dir.y;
      Side proven = Side::unknown;
      if (std::min(y0, y1) > scale * range.high + tolerance) proven = Side::above;
      if (std::max(y0, y1) < scale * range.low - tolerance) proven = Side::below;
      if (proven != Side::unknown) {
        if (side != Side::unknown && side != proven) return t;
        side = proven;
        descend = false;
      }
    }
    if (descend) {
      if (level > 0) {
        --level;
        const bool past_x = t >= plane_x((2 * i + 1) << level), past_z = t >= plane_z((2 * j + 1) << level);
        i = 2 * i + (past_x == (step_x > 0) ? 1 : 0);
        j = 2 * j + (past_z == (step_z > 0) ? 1 : 0);
        continue;
      }
      if (float t_hit = t; leaf(i, j, t_hit, t_exit, side)) return t_hit;
    }
    if (t_exit >= ray.t_end) return std::nullopt;
    const int i_before = i, j_before = j;
    (exit_x <= exit_z ? i : j) += exit_x <= exit_z ? step_x : step_z;
    const int n = pyramid.resolution(level);
    if (i < 0 || j < 0 || i >= n || j >= n) return std::nullopt;
    t = t_exit;
    if ((i >> 1) != (i_before >> 1) || (j >> 1) != (j_before >> 1)) {
      ++level;
      i >>= 1;
      j >>= 1;
    }
  }
}

}  // namespace becalm::tracer
