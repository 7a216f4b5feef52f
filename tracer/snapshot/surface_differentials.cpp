#include "tracer/snapshot/surface_differentials.h"

#include <array>
#include <cmath>

#include "tracer/math/ray_differential.h"
#include "tracer/math/shading_frame.h"

namespace becalm::tracer {

namespace {

/// uvs span an area if the sine between their edges exceeds this: 32-bit uvs resolve no less.
constexpr double kLeastUvSine = 1e-6;

/// Turns changes along two edges of a triangle into changes along its parameters u and v.
struct FromEdges {
  V2d duv1, duv2;
  double determinant;

  bool span_area() const {
    const double longest = std::sqrt(duv1.dot(duv1)) * std::sqrt(duv2.dot(duv2));
    return std::abs(determinant) > kLeastUvSine * longest;  // false for NaN
  }
  V3f du(const V3f& d1, const V3f& d2) const {
    return V3f((V3d(d1) * duv2.y - V3d(d2) * duv1.y) * (1.0 / determinant));
  }
  V3f dv(const V3f& d1, const V3f& d2) const {
    return V3f((V3d(d2) * duv1.x - V3d(d1) * duv2.x) * (1.0 / determinant));
  }
};

FromEdges from_edges(const V2d& duv1, const V2d& duv2) {
  return {duv1, duv2, duv1.x * duv2.y - duv1.y * duv2.x};
}

V3f finite_or_zero(const V3f& v) {
  return is_finite(v) ? v : V3f(0.0f);
}

/// A triangle's parameters.
struct Parameters {
  FromEdges from_edges;
  SurfaceTangents tangents;
};

/// In double: the cross product of edges of 1e-30 is not 0.
V3f geometric_normal(const V3f& edge1, const V3f& edge2) {
  const V3d cross = V3d(edge1).cross(V3d(edge2));
  const double area = std::sqrt(cross.dot(cross));
  return area > 0.0 ? V3f(cross / area) : V3f(0.0f, 0.0f, 1.0f);
}

/// Whether they span a plane. Tangents of length 0 are of no use either.
bool span_plane(const V3f& dpdu, const V3f& dpdv) {
  const V3d cross = V3d(dpdu).cross(V3d(dpdv));
  return cross.dot(cross) > 0.0 && is_finite(dpdu) && is_finite(dpdv);
}

Parameters parameters_of(const Mesh& mesh, const std::array<std::uint32_t, 3>& corners, const V3f& edge1,
                         const V3f& edge2) {
  if (!mesh.uvs.empty()) {
    const V2d uv0(mesh.uvs[corners[0]]);
    const FromEdges by_uvs = from_edges(V2d(mesh.uvs[corners[1]]) - uv0, V2d(mesh.uvs[corners[2]]) - uv0);
    if (by_uvs.span_area()) {
      const V3f dpdu = by_uvs.du(edge1, edge2), dpdv = by_uvs.dv(edge1, edge2);
      if (span_plane(dpdu, dpdv)) return {by_uvs, {dpdu, dpdv, true}};
    }
  }
  const ShadingFrame frame = ShadingFrame::from_normal(geometric_normal(edge1, edge2));
  const auto in_plane = [&](const V3f& edge) {
    return V2d(V3d(edge).dot(V3d(frame.tangent)), V3d(edge).dot(V3d(frame.bitangent)));
  };
  return {from_edges(in_plane(edge1), in_plane(edge2)), {frame.tangent, frame.bitangent, false}};
}

}  // namespace

SurfaceTangents surface_tangents(const Mesh& mesh, std::uint32_t triangle) {
  const auto& corners = mesh.triangles[triangle];
  const V3f& p0 = mesh.positions[corners[0]];
  return parameters_of(mesh, corners, mesh.positions[corners[1]] - p0, mesh.positions[corners[2]] - p0)
      .tangents;
}

SurfaceDifferentials surface_differentials(const Mesh& mesh, std::uint32_t triangle, float b1, float b2) {
  const auto& corners = mesh.triangles[triangle];
  const V3f& p0 = mesh.positions[corners[0]];
  const V3f edge1 = mesh.positions[corners[1]] - p0, edge2 = mesh.positions[corners[2]] - p0;
  const auto [parameters, tangents] = parameters_of(mesh, corners, edge1, edge2);
  const V3f geometric = geometric_normal(edge1, edge2);
  SurfaceDifferentials result{tangents.dpdu, tangents.dpdv, geometric,
                              V3f(0.0f),     V3f(0.0f),     tangents.has_uvs};
  if (!mesh.normals.empty()) {
    const V3f &n0 = mesh.normals[corners[0]], &n1 = mesh.normals[corners[1]], &n2 = mesh.normals[corners[2]];
    const V3f interpolated = n0 * (1.0f - b1 - b2) + n1 * b1 + n2 * b2;
    const float cosine = interpolated.dot(geometric);
    // As surface_at does: normals that cancel out leave the geometric one, those that point inward are
    // turned.
    if (cosine != 0.0f && std::isfinite(cosine)) {
      const float side = cosine > 0.0f ? 1.0f : -1.0f;
      result.normal = (interpolated * side).normalized();
      if (parameters.span_area()) {
        const auto change = [&](const V3f& dn) {
          return finite_or_zero(unit_derivative(interpolated, dn) * side);
        };
        result.dndu = change(parameters.du(n1 - n0, n2 - n0));
        result.dndv = change(parameters.dv(n1 - n0, n2 - n0));
      }
    }
  }
  return result;
}

SurfaceDifferentials transformed(const SurfaceDifferentials& object, const M44f& to_world,
                                 const M44f& normal_to_world) {
  const V3f normal = transform_vector(object.normal, normal_to_world);
  const auto change = [&](const V3f& dn) {
    return finite_or_zero(unit_derivative(normal, transform_vector(dn, normal_to_world)));
  };
  return {transform_vector(object.dpdu, to_world),
          transform_vector(object.dpdv, to_world),
          normal.normalized(),
          change(object.dndu),
          change(object.dndv),
          object.has_uvs};
}

}  // namespace becalm::tracer
