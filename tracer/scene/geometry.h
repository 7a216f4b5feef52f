#pragma once

#include <Imath/ImathBox.h>

#include <variant>

#include "tracer/scene/mesh.h"

namespace becalm::tracer {

/// The exact sphere of radius 1 around the origin: no triangles, no memory, no facets. Its u runs around, its
/// v from the south pole to the north, as make_sphere's do.
struct UnitSphere {};

/// What an object's surface is, in object space.
using Geometry = std::variant<Mesh, UnitSphere>;

Imath::Box3f bounds(const Geometry& geometry);

/// 0 for what is not made of triangles.
std::size_t triangle_count(const Geometry& geometry);

}  // namespace becalm::tracer
