#pragma once

#include <Imath/ImathBox.h>

#include <compare>
#include <variant>

#include "tracer/procedural/procedural.h"
#include "tracer/scene/mesh.h"

namespace becalm::tracer {

/// The exact sphere of radius 1 around the origin: no triangles, no memory, no facets. Its u runs around, its
/// v from the south pole to the north, as make_sphere's do.
struct UnitSphere {
  friend auto operator<=>(const UnitSphere&, const UnitSphere&) = default;
};

/// What a scene file says of an object's surface, in object space.
using Geometry = std::variant<Mesh, UnitSphere, ProceduralDescription>;

/// The same at one frame; refers to what it is made of.
using Shape = std::variant<const Mesh*, UnitSphere, const Procedural*>;

Imath::Box3f bounds(const Shape& shape);

/// 0 for what is not made of triangles.
std::size_t triangle_count(const Shape& shape);
std::size_t triangle_count(const Geometry& geometry);

/// The mesh, or null.
inline const Mesh* mesh_of(const Shape& shape) {
  const auto* mesh = std::get_if<const Mesh*>(&shape);
  return mesh != nullptr ? *mesh : nullptr;
}
inline const Procedural* procedural_of(const Shape& shape) {
  const auto* procedural = std::get_if<const Procedural*>(&shape);
  return procedural != nullptr ? *procedural : nullptr;
}

}  // namespace becalm::tracer
