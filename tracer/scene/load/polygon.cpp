#include "tracer/scene/load/polygon.h"

#include <cassert>

namespace becalm::tracer {

namespace {

/// Newell's method: the sum of the cross products, twice the area along each axis.
V3d area_normal(std::span<const V3f> corners) {
  V3d sum(0.0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    sum += V3d(corners[i] - corners[0]).cross(V3d(corners[(i + 1) % corners.size()] - corners[0]));
  }
  return sum;
}

/// The corners along the axis that the polygon faces most, counter-clockwise.
std::vector<V2d> projected(std::span<const V3f> corners) {
  const V3d normal = area_normal(corners);
  int axis = 0;
  for (const int other : {1, 2}) {
    if (std::abs(normal[other]) > std::abs(normal[axis])) axis = other;
  }
  int right = (axis + 1) % 3, up = (axis + 2) % 3;
  if (normal[axis] < 0.0) std::swap(right, up);
  std::vector<V2d> points;
  points.reserve(corners.size());
  for (const V3f& corner : corners) points.emplace_back(corner[right], corner[up]);
  return points;
}

/// Twice the area of the triangle, positive if it is counter-clockwise.
double area(const V2d& a, const V2d& b, const V2d& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether the triangle is part of the polygon and cuts off nothing but its middle corner.
bool is_ear(const std::vector<V2d>& points, const std::vector<std::uint32_t>& polygon,
            const std::array<std::uint32_t, 3>& triangle) {
  const V2d &a = points[triangle[0]], &b = points[triangle[1]], &c = points[triangle[2]];
  if (!(area(a, b, c) > 0.0)) return false;
  return std::ranges::none_of(polygon, [&](std::uint32_t corner) {
    const V2d& p = points[corner];
    if (p == a || p == b || p == c) return false;
    return area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0;
  });
}

void clip_ears(std::span<const V3f> corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const std::vector<V2d> points = projected(corners);
  std::vector<std::uint32_t> polygon(corners.size());  // what is left of it
  for (std::uint32_t i = 0; i < polygon.size(); ++i) polygon[i] = i;
  std::size_t start = 0;
  while (polygon.size() > 3) {
    const auto at = [&](std::size_t i) { return polygon[i % polygon.size()]; };
    const auto triangle = [&](std::size_t i) { return std::array{at(i), at(i + 1), at(i + 2)}; };
    std::size_t tries = 0;
    while (tries < polygon.size() && !is_ear(points, polygon, triangle(start + tries))) ++tries;
    start = (start + tries) % polygon.size();  // where it began, if there is no ear
    triangles.push_back(triangle(start));
    const std::size_t tip = (start + 1) % polygon.size();
    polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>(tip));
    if (tip < start) --start;
  }
  triangles.push_back({polygon[0], polygon[1], polygon[2]});
}

/// Whether the triangles that the quadrilateral is cut into from `corner` lie within it.
bool cuts_within(std::span<const V3f> corners, std::size_t corner) {
  const V3d normal = area_normal(corners);
  const auto at = [&](std::size_t i) { return V3d(corners[(corner + i) % 4]); };
  const auto faces_along = [&](std::size_t b, std::size_t c) {
    return (at(b) - at(0)).cross(at(c) - at(0)).dot(normal) > 0.0;
  };
  return faces_along(1, 2) && faces_along(2, 3);
}

/// Whether a quadrilateral is cut from its first corner and not from its second.
bool cuts_from_first(std::span<const V3f> corners) {
  const bool is_shorter = (corners[2] - corners[0]).length2() < (corners[3] - corners[1]).length2();
  if (cuts_within(corners, is_shorter ? 0 : 1)) return is_shorter;
  return cuts_within(corners, is_shorter ? 1 : 0) ? !is_shorter : is_shorter;
}

}  // namespace

void cut_polygon(std::span<const V3f> corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  assert(corners.size() >= 3);
  if (corners.size() == 3) {
    triangles.push_back({0, 1, 2});
  } else if (corners.size() > 4) {
    clip_ears(corners, triangles);
  } else if (cuts_from_first(corners)) {
    triangles.insert(triangles.end(), {{0, 1, 2}, {0, 2, 3}});
  } else {
    triangles.insert(triangles.end(), {{0, 1, 3}, {1, 2, 3}});
  }
}

}  // namespace becalm::tracer
