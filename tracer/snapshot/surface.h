#pragma once

#include "tracer/snapshot/snapshot.h"
#include "tracer/snapshot/surface_differentials.h"

namespace becalm::tracer {

/// The point of a surface that a ray hit, in world space.
struct Surface {
  V3f position;
  V3f normal_geometric;  ///< unit, on the outside: the side from which the triangle is counter-clockwise
  V3f normal_shading;    ///< unit, interpolated, in the hemisphere of the geometric one
  V2f uv;
  float slope_variance = 0.0f;  ///< of the slopes that averaging over the footprint took out of the normal
  float offset;  ///< bound of the rounding errors in the position and in what Embree makes of it
};

/// `place` is the object's at the ray's time. `footprint` is the length, in world space, over which
/// procedural surfaces average their normals.
Surface surface_at(const ObjectState& object, const Place& place, const Hit& hit, float footprint = 0.0f);

/// How the surface changes around the hit, in world space: only along it, or with its normal.
SurfaceTangents tangents_at(const ObjectState& object, const Place& place, const Hit& hit);
SurfaceDifferentials differentials_at(const ObjectState& object, const Place& place, const Hit& hit);

/// Where a ray leaves the surface in this direction: off it by more than rounding errors, on the ray's side.
inline V3f offset_origin(const Surface& surface, const V3f& dir_world) {
  const float side = dir_world.dot(surface.normal_geometric) < 0.0f ? -1.0f : 1.0f;
  return surface.position + surface.normal_geometric * (side * surface.offset);
}

/// How far beyond the surface, along its direction, a ray starts that leaves it from offset_origin(). Media
/// count this distance too, which is a large share of thin sheets. Exact for flat surfaces that are not
/// grazed.
inline float skipped_length(const Surface& surface, const V3f& dir_world) {
  constexpr float least_cos = 0.01f;
  return surface.offset / std::max(std::abs(dir_world.dot(surface.normal_geometric)), least_cos);
}

/// The hit point at this frame's place of its object, and at the previous frame's, in double.
struct PointMotion {
  V3d current, previous;
};
PointMotion point_motion(const ObjectState& object, const Hit& hit, float time);

}  // namespace becalm::tracer
