#pragma once

#include <cstdint>

#include "tracer/math/vec.h"
#include "tracer/scene/mesh.h"

namespace becalm::tracer {

/// How position changes with a surface's parameters.
struct SurfaceTangents {
  V3f dpdu, dpdv;
  bool has_uvs;  ///< whether the parameters are the mesh's uvs
};

/// How position and shading normal change with a surface's parameters.
struct SurfaceDifferentials {
  V3f dpdu, dpdv;
  V3f normal;      ///< unit shading normal, in the hemisphere of the geometric one
  V3f dndu, dndv;  ///< of the unit normal, so perpendicular to it
  bool has_uvs;    ///< as SurfaceTangents has it
};

/// At barycentrics (b1, b2) of a triangle, in object space. Where the mesh has no uvs, or those of the
/// triangle span no area, the parameters are lengths along an orthonormal frame of the triangle's plane: good
/// for tangents and for the curvature of mirrors, but not for textures. Triangles without area get a frame of
/// the z axis and no curvature.
SurfaceDifferentials surface_differentials(const Mesh& mesh, std::uint32_t triangle, float b1, float b2);

/// The part of it that does not need the normals, for half of the time.
SurfaceTangents surface_tangents(const Mesh& mesh, std::uint32_t triangle);

/// The differentials in world space; `normal_to_world` is the inverse transpose of `to_world`.
SurfaceDifferentials transformed(const SurfaceDifferentials& object, const M44f& to_world,
                                 const M44f& normal_to_world);

}  // namespace becalm::tracer
