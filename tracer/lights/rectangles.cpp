#include "tracer/lights/rectangles.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace becalm::tracer {

namespace {

/// The first triangle's corner at which both make a rectangle.
std::optional<std::uint8_t> rectangle_corner(const TriangleKey& a, const TriangleKey& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const V3f &from = a[(i + 1) % 3], &to = a[(i + 2) % 3];
      if (b[(j + 1) % 3] != to || b[(j + 2) % 3] != from) continue;
      const V3d e1 = V3d(from) - V3d(a[i]), e2 = V3d(to) - V3d(a[i]);
      const V3d beyond = V3d(b[j]) - (V3d(a[i]) + e1 + e2);
      // Rounding of coordinates, and what it makes of a right angle.
      constexpr double tolerance = 1e-4;
      const double least_length = std::sqrt(std::min(e1.length2(), e2.length2()));
      if (!(beyond.length() <= tolerance * least_length)) return std::nullopt;
      if (!(std::abs(e1.dot(e2)) <= tolerance * e1.cross(e2).length())) return std::nullopt;
      return static_cast<std::uint8_t>(i);
    }
  }
  return std::nullopt;
}

TriangleKey corners(const EmissiveTriangle& triangle) {
  return {triangle.p0, triangle.p1, triangle.p2};
}

std::optional<std::uint8_t> rectangle_corner(const EmissiveTriangle& a, const EmissiveTriangle& b,
                                             std::span<const TriangleKey> keys) {
  if (a.radiance != b.radiance || a.two_sided != b.two_sided || a.group != b.group ||
      a.motion.segments != b.motion.segments)
    return std::nullopt;
  if (!a.motion.moving()) return rectangle_corner(corners(a), corners(b));
  std::optional<std::uint8_t> corner;
  for (std::uint32_t i = 0; i <= a.motion.segments; ++i) {
    const auto found = rectangle_corner(keys[a.motion.first + i], keys[b.motion.first + i]);
    if (!found || (corner && found != corner)) return std::nullopt;
    corner = found;
  }
  return corner;
}

}  // namespace

std::vector<TriangleOrRectangle> find_rectangles(std::span<const EmissiveTriangle> triangles,
                                                 std::span<const TriangleKey> keys) {
  std::vector<TriangleOrRectangle> found;
  found.reserve(triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    TriangleOrRectangle& next = found.emplace_back(TriangleOrRectangle{.triangle = i});
    if (i + 1 == triangles.size()) break;
    const auto corner = rectangle_corner(triangles[i], triangles[i + 1], keys);
    if (!corner) continue;
    next.corner = *corner;
    next.rectangle = true;
    ++i;
  }
  return found;
}

}  // namespace becalm::tracer
