#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Appends the triangles, as numbers of corners, that a polygon of at least 3 corners is cut into: two fewer
/// than it has corners, of the same winding. A quadrilateral is cut along its shorter diagonal, unless only
/// the longer one lies within it, a polygon of more corners by ear clipping in the plane of its mean normal.
/// A polygon that is not flat or crosses itself is cut as far as that goes and then as a fan.
void cut_polygon(std::span<const V3f> corners, std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace becalm::tracer
