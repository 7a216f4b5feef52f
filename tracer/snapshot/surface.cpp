#include "tracer/snapshot/surface.h"

#include <numbers>

#include "tracer/math/shading_frame.h"

namespace becalm::tracer {

namespace {

/// Largest rounding error of a hit relative to the size of the numbers that went into it. Embree's edge tests
/// and the transforms lose a few units in the last place (2^-24) of the triangle's coordinates; eight times
/// as much leaves room for rotated and scaled instances. Verified by the closed-box tests at three scales.
constexpr float kRelativeOffset = 0x1p-20f;

V3d local_position(const ObjectState& object, const Hit& hit) {
  if (object.mesh == nullptr) return V3d(hit.local);
  const auto& corners = object.mesh->triangles[hit.triangle];
  const V3d p0(object.mesh->positions[corners[0]]);
  const V3d p1(object.mesh->positions[corners[1]]);
  const V3d p2(object.mesh->positions[corners[2]]);
  return p0 + (p1 - p0) * hit.u + (p2 - p0) * hit.v;
}

float rounding_error(const ObjectState& object, float largest_coordinate) {
  return kRelativeOffset * (largest_coordinate * object.scale + object.translation);
}

Surface mesh_surface(const ObjectState& object, const Place& place, const Hit& hit) {
  const Mesh& mesh = *object.mesh;
  const auto& corners = mesh.triangles[hit.triangle];
  const V3f& p0 = mesh.positions[corners[0]];
  const V3f& p1 = mesh.positions[corners[1]];
  const V3f& p2 = mesh.positions[corners[2]];
  const V3f edge1 = p1 - p0, edge2 = p2 - p0;
  const float w0 = 1.0f - hit.u - hit.v;

  Surface surface;
  surface.position = transform_point(p0 + edge1 * hit.u + edge2 * hit.v, place.to_world);
  const V3f cross = edge1.cross(edge2);
  surface.normal_geometric = transform_vector(cross, place.normal_to_world).normalized();
  surface.normal_shading = surface.normal_geometric;
  if (!mesh.normals.empty()) {
    const V3f interpolated =
        mesh.normals[corners[0]] * w0 + mesh.normals[corners[1]] * hit.u + mesh.normals[corners[2]] * hit.v;
    const V3f normal = transform_vector(interpolated, place.normal_to_world).normalized();
    // Normals that cancel out leave the geometric one; files whose normals point inward still mean the same
    // surface.
    const float cos_angle = normal.dot(surface.normal_geometric);
    if (cos_angle != 0.0f) surface.normal_shading = cos_angle > 0.0f ? normal : -normal;
  }

  surface.uv = V2f(0.0f);
  if (!mesh.uvs.empty())
    surface.uv = mesh.uvs[corners[0]] * w0 + mesh.uvs[corners[1]] * hit.u + mesh.uvs[corners[2]] * hit.v;

  float largest = 0.0f;
  for (const V3f* p : {&p0, &p1, &p2}) {
    largest = std::max({largest, std::abs(p->x), std::abs(p->y), std::abs(p->z)});
  }
  surface.offset = rounding_error(object, largest);
  return surface;
}

Surface sphere_surface(const ObjectState& object, const Place& place, const Hit& hit) {
  constexpr float pi = std::numbers::pi_v<float>;
  const V3f local = hit.local.normalized();  // back onto the sphere
  Surface surface;
  surface.position = transform_point(local, place.to_world);
  surface.normal_geometric = transform_vector(local, place.normal_to_world).normalized();
  surface.normal_shading = surface.normal_geometric;
  const float around = std::atan2(local.x, local.z) / (2.0f * pi);
  surface.uv =
      V2f(around < 0.0f ? around + 1.0f : around, 1.0f - std::acos(std::clamp(local.y, -1.0f, 1.0f)) / pi);
  surface.offset = rounding_error(object, 1.0f);
  return surface;
}

Surface procedural_surface(const ObjectState& object, const Procedural& procedural, const Place& place,
                           const Hit& hit, float footprint) {
  const ProceduralPoint local = point(procedural, hit.local);
  const ProceduralPoint averaged =
      footprint > 0.0f ? point(procedural, hit.local, footprint / object.length_scale) : local;
  Surface surface;
  surface.position = transform_point(local.position, place.to_world);
  surface.normal_geometric = transform_vector(local.normal, place.normal_to_world).normalized();
  surface.normal_shading = transform_vector(averaged.normal, place.normal_to_world).normalized();
  if (surface.normal_shading.dot(surface.normal_geometric) <= 0.0f)
    surface.normal_shading = surface.normal_geometric;
  surface.uv = local.uv;
  surface.slope_variance = averaged.slope_variance;
  surface.offset =
      rounding_error(object, max_component({std::abs(local.position.x), std::abs(local.position.y),
                                            std::abs(local.position.z)})) +
      local.error * object.scale;
  return surface;
}

/// Of the unit sphere, whose normal is its position.
SurfaceDifferentials sphere_differentials(const V3f& p) {
  constexpr float pi = std::numbers::pi_v<float>;
  const float ring = std::sqrt(p.x * p.x + p.z * p.z);
  // At the poles u has no direction; any will do.
  const V3f around = ring > 0.0f ? V3f(p.z / ring, 0.0f, -p.x / ring) : V3f(1.0f, 0.0f, 0.0f);
  const V3f dpdu = around * (2.0f * pi * std::max(ring, 1e-6f));
  const V3f dpdv = p.cross(around) * pi;
  return {dpdu, dpdv, p, dpdu, dpdv, true};
}

/// A frame in the plane of the normal: good for tangents, not for textures. Taken as flat.
SurfaceDifferentials procedural_differentials(const Procedural& procedural, const V3f& p) {
  const ShadingFrame frame = ShadingFrame::from_normal(point(procedural, p).normal);
  return {frame.tangent, frame.bitangent, frame.normal, V3f(0.0f), V3f(0.0f), false};
}

}  // namespace

SurfaceTangents tangents_at(const ObjectState& object, const Place& place, const Hit& hit) {
  const SurfaceTangents local = [&]() -> SurfaceTangents {
    if (object.mesh != nullptr) return surface_tangents(*object.mesh, hit.triangle);
    const Procedural* procedural = procedural_of(object.shape);
    const SurfaceDifferentials around = procedural != nullptr
                                            ? procedural_differentials(*procedural, hit.local)
                                            : sphere_differentials(hit.local.normalized());
    return {around.dpdu, around.dpdv, around.has_uvs};
  }();
  return {transform_vector(local.dpdu, place.to_world), transform_vector(local.dpdv, place.to_world),
          local.has_uvs};
}

SurfaceDifferentials differentials_at(const ObjectState& object, const Place& place, const Hit& hit) {
  if (object.mesh != nullptr) {
    return transformed(surface_differentials(*object.mesh, hit.triangle, hit.u, hit.v), place.to_world,
                       place.normal_to_world);
  }
  if (const Procedural* procedural = procedural_of(object.shape))
    return transformed(procedural_differentials(*procedural, hit.local), place.to_world,
                       place.normal_to_world);
  return transformed(sphere_differentials(hit.local.normalized()), place.to_world, place.normal_to_world);
}

Surface surface_at(const ObjectState& object, const Place& place, const Hit& hit, float footprint) {
  if (object.mesh != nullptr) return mesh_surface(object, place, hit);
  if (const Procedural* procedural = procedural_of(object.shape))
    return procedural_surface(object, *procedural, place, hit, footprint);
  return sphere_surface(object, place, hit);
}

PointMotion point_motion(const ObjectState& object, const Hit& hit, float time) {
  const V3d point = local_position(object, hit);
  const Procedural* procedural = procedural_of(object.shape);
  const V3d previous = procedural != nullptr ? V3d(point_before(*procedural, hit.local)) : point;
  return {transform_point(point, object.exact.at(time)),
          transform_point(previous, object.exact_previous.at(time))};
}

}  // namespace becalm::tracer
