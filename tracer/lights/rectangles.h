#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tracer/lights/area_light.h"

namespace becalm::tracer {

/// A triangle of a list, or the rectangle that it makes with the next one.
struct TriangleOrRectangle {
  std::uint32_t triangle;
  std::uint8_t corner = 0;  ///< of the triangle: opposite to the diagonal of the rectangle
  bool rectangle = false;

  /// Its place where the triangle's corners are these.
  AreaShape shape(const TriangleKey& corners) const {
    const V3f& p0 = corners[corner];
    return {p0, corners[(corner + 1) % 3] - p0, corners[(corner + 2) % 3] - p0, rectangle};
  }
};

/// The list in order, with neighbours of equal emission that make a rectangle, at all keys if they move, as
/// one: what a mesh's quads are cut into.
std::vector<TriangleOrRectangle> find_rectangles(std::span<const EmissiveTriangle> triangles,
                                                 std::span<const TriangleKey> keys);

}  // namespace becalm::tracer
