// Ray differentials against finite differences of traced rays, surface differentials against moved points.
#include "tracer/math/ray_differential.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>

#include "tracer/snapshot/surface_differentials.h"

namespace becalm::tracer {
namespace {

struct RayD {
  V3d origin, dir;
};

/// A camera's ray at picture position (x, y): off centre, so that nothing is symmetric.
RayD camera_ray(double x, double y) {
  return {V3d(0.1 * x, 0.05 * y, 5.0), V3d(0.3 + 0.4 * x + 0.1 * y, -0.2 + 0.35 * y, -1.0).normalized()};
}

constexpr double kStep = 1e-5;

template <class Function>
V3f difference(const Function& function, bool along_x) {
  const double dx = along_x ? kStep : 0.0, dy = along_x ? 0.0 : kStep;
  return V3f((function(dx, dy) - function(-dx, -dy)) / (2.0 * kStep));
}

RayDifferential camera_differential() {
  const auto origin = [](double x, double y) { return camera_ray(x, y).origin; };
  const V3f d(0.3f, -0.2f, -1.0f);
  return {difference(origin, true), difference(origin, false), unit_derivative(d, V3f(0.4f, 0, 0)),
          unit_derivative(d, V3f(0.1f, 0.35f, 0))};
}

void expect_near(const V3f& value, const V3f& truth, float tolerance = 2e-4f) {
  EXPECT_LT((value - truth).length(), tolerance * (1.0f + truth.length()))
      << value << " instead of " << truth;
}

/// A sphere of radius 2 around the origin, curved mirror or lens.
constexpr double kRadius = 2.0;
V3d hit_sphere(const RayD& ray) {
  const double b = ray.origin.dot(ray.dir), c = ray.origin.dot(ray.origin) - kRadius * kRadius;
  return ray.origin + ray.dir * (-b - std::sqrt(b * b - c));
}

TEST(RayDifferential, DirectionsFollowTheCamera) {
  const auto direction = [](double x, double y) { return camera_ray(x, y).dir; };
  const RayDifferential start = camera_differential();
  expect_near(start.dddx, difference(direction, true));
  expect_near(start.dddy, difference(direction, false));
}

TEST(RayDifferential, TransferToAPlane) {
  const V3d normal = V3d(0.2, 0.5, 1.0).normalized();
  const auto hit = [&](double x, double y) {
    const RayD ray = camera_ray(x, y);
    return ray.origin - ray.dir * (ray.origin.dot(normal) / ray.dir.dot(normal));
  };
  const RayD ray = camera_ray(0, 0);
  const float t = static_cast<float>((hit(0, 0) - ray.origin).length());
  for (const double side : {1.0, -1.0}) {
    const RayDifferential at = transferred(camera_differential(), V3f(ray.dir), t, V3f(normal * side));
    expect_near(at.dpdx, difference(hit, true));
    expect_near(at.dpdy, difference(hit, false));
    EXPECT_NEAR(at.dpdx.dot(V3f(normal)), 0.0f, 1e-5f);
  }
}

/// Mirror and lens: the direction that leaves the sphere, by finite differences of the whole construction.
TEST(RayDifferential, ReflectAndRefractAtACurvedSurface) {
  const auto bounce = [&](double x, double y, double eta) {
    const RayD ray = camera_ray(x, y);
    const V3d n = hit_sphere(ray) / kRadius;
    const double cos_i = ray.dir.dot(n);
    if (eta == 0.0) return ray.dir - n * (2.0 * cos_i);
    const double cos_t = std::sqrt(1.0 - eta * eta * (1.0 - cos_i * cos_i));
    return ray.dir * eta - n * (eta * cos_i + cos_t);
  };
  const RayD ray = camera_ray(0, 0);
  const V3d point = hit_sphere(ray);
  const V3f normal(point / kRadius), dir(ray.dir);
  const RayDifferential at =
      transferred(camera_differential(), dir, static_cast<float>((point - ray.origin).length()), normal);
  const V3f dndx = at.dpdx / static_cast<float>(kRadius), dndy = at.dpdy / static_cast<float>(kRadius);
  // The surface's other side has the opposite normal, which changes oppositely.
  for (const float side : {1.0f, -1.0f}) {
    const RayDifferential mirrored = reflected(at, dir, normal * side, dndx * side, dndy * side);
    expect_near(mirrored.dddx, difference([&](double x, double y) { return bounce(x, y, 0.0); }, true));
    expect_near(mirrored.dddy, difference([&](double x, double y) { return bounce(x, y, 0.0); }, false));
    EXPECT_EQ(mirrored.dpdx, at.dpdx);
    for (const float eta : {1.0f / 1.5f, 1.0f, 1.02f}) {
      const RayDifferential bent = refracted(at, dir, normal * side, dndx * side, dndy * side, eta);
      expect_near(bent.dddx, difference([&](double x, double y) { return bounce(x, y, eta); }, true));
      expect_near(bent.dddy, difference([&](double x, double y) { return bounce(x, y, eta); }, false));
    }
  }
}

TEST(RayDifferential, ScatteringWidens) {
  const V3f dir = V3f(0.3f, -0.4f, 0.5f).normalized();
  const RayDifferential narrow{V3f(1, 2, 3), V3f(4, 5, 6), V3f(0.01f, 0, 0), V3f(0, 0.02f, 0)};
  const RayDifferential wide = scattered(narrow, dir, 0.1f);
  EXPECT_EQ(wide.dpdy, narrow.dpdy);
  EXPECT_NEAR(wide.dddx.length(), 0.1f, 1e-6f);
  EXPECT_NEAR(wide.dddy.length(), 0.1f, 1e-6f);
  EXPECT_NEAR(wide.dddx.dot(wide.dddy), 0.0f, 1e-7f);
  EXPECT_NEAR(wide.dddx.dot(dir), 0.0f, 1e-7f);
  EXPECT_NEAR(scattered({V3f(0), V3f(0), V3f(0.5f, 0, 0), V3f(0)}, dir, 0.1f).dddx.length(), 0.5f, 1e-6f)
      << "never narrower";
}

TEST(RayDifferential, FiniteAtTheExtremes) {
  const RayDifferential start = camera_differential();
  const V3f dir(1, 0, 0), normal(0, 0, 1);
  for (const V3f& grazing : {dir, V3f(1.0f, 0.0f, 1e-30f), V3f(1.0f, 0.0f, -1e-8f)}) {
    const RayDifferential at = transferred(start, grazing, 1e10f, normal);
    EXPECT_TRUE(is_finite(at.dpdx) && is_finite(at.dpdy)) << grazing;
    const RayDifferential bent = refracted(start, grazing, normal, V3f(0), V3f(0), 0.5f);
    EXPECT_TRUE(is_finite(bent.dddx) && is_finite(bent.dddy)) << grazing;
  }
  // At and beyond the critical angle.
  const V3f critical = V3f(1.0f / 1.5f, 0.0f, -std::sqrt(1.0f - 1.0f / 2.25f));
  EXPECT_TRUE(is_finite(refracted(start, critical, normal, V3f(1), V3f(1), 1.5f).dddx));
  EXPECT_EQ(refracted(start, V3f(0.9f, 0, -0.43f).normalized(), normal, V3f(1), V3f(1), 1.5f).dddx,
            start.dddx);
  EXPECT_EQ(unit_derivative(V3f(0.0f), V3f(1.0f)), V3f(0.0f));
  expect_near(unit_derivative(V3f(1e-30f, 0, 0), V3f(0, 1e-30f, 0)), V3f(0, 1, 0));
}

TEST(ParameterFootprint, InvertsTheSurfacesDerivatives) {
  const V3f dpdu(2.0f, 0.5f, 0.1f), dpdv(-0.3f, 3.0f, 1.0f);
  for (const float scale : {1e-18f, 1.0f, 1e18f}) {
    const V2f duv_dx(0.02f, -0.01f), duv_dy(0.003f, 0.04f);
    const V3f u = dpdu * scale, v = dpdv * scale;
    const ParameterFootprint footprint =
        parameter_footprint(u * duv_dx.x + v * duv_dx.y, u * duv_dy.x + v * duv_dy.y, u, v);
    EXPECT_LT((footprint.duv_dx - duv_dx).length(), 1e-6f) << scale;
    EXPECT_LT((footprint.duv_dy - duv_dy).length(), 1e-6f) << scale;
  }
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto& [u, v] : {std::pair(V3f(0.0f), V3f(0.0f)), std::pair(V3f(1, 0, 0), V3f(2, 0, 0)),
                             std::pair(V3f(nan), V3f(0, 1, 0)), std::pair(V3f(1, 0, 0), V3f(0.0f))}) {
    const ParameterFootprint footprint = parameter_footprint(V3f(1, 1, 0), V3f(1, 0, 0), u, v);
    EXPECT_EQ(footprint.duv_dx, V2f(0.0f)) << u << v;
    EXPECT_EQ(footprint.duv_dy, V2f(0.0f)) << u << v;
  }
}

Mesh triangle(bool with_uvs) {
  Mesh mesh;
  mesh.positions = {V3f(0, 0, 0), V3f(2, 0.5f, 0), V3f(0.3f, 1.5f, 0.8f)};
  mesh.normals = {V3f(0.1f, -0.3f, 1).normalized(), V3f(0.5f, -0.4f, 1.2f),
                  V3f(-0.2f, -0.6f, 0.9f).normalized()};
  if (with_uvs) mesh.uvs = {V2f(0.1f, 0.2f), V2f(0.9f, 0.1f), V2f(0.4f, 0.7f)};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// Moving by du dpdu + dv dpdv moves the point along the triangle, and the unit normal by du dndu + dv dndv,
/// as barycentrics that are moved a little show.
void expect_matches_moved_points(const Mesh& mesh, const M44f& to_world) {
  const M44f normal_to_world = to_world.inverse().transposed();
  const float b1 = 0.3f, b2 = 0.25f;
  const SurfaceDifferentials s =
      transformed(surface_differentials(mesh, 0, b1, b2), to_world, normal_to_world);
  EXPECT_EQ(s.has_uvs, !mesh.uvs.empty());
  const SurfaceTangents along = surface_tangents(mesh, 0);
  EXPECT_EQ(transform_vector(along.dpdu, to_world), s.dpdu);
  EXPECT_EQ(transform_vector(along.dpdv, to_world), s.dpdv);
  EXPECT_EQ(along.has_uvs, s.has_uvs);
  const auto weights = [](double c1, double c2) { return V3d(1.0 - c1 - c2, c1, c2); };
  const auto normal_at = [&](double c1, double c2) {
    const V3d w = weights(c1, c2);
    V3d n(0.0);
    for (int i = 0; i < 3; ++i) n += V3d(mesh.normals[i]) * w[i];
    return transform_vector(n, M44d(normal_to_world)).normalized();
  };
  expect_near(s.normal, V3f(normal_at(b1, b2)));
  for (const V2d& step : {V2d(1, 0), V2d(0, 1)}) {
    const V3d edge = V3d(mesh.positions[1] - mesh.positions[0]) * step.x +
                     V3d(mesh.positions[2] - mesh.positions[0]) * step.y;
    const V3f moved(transform_vector(edge, M44d(to_world)));
    const ParameterFootprint parameters = parameter_footprint(moved, V3f(0.0f), s.dpdu, s.dpdv);
    if (!mesh.uvs.empty()) {
      const V2f duv = mesh.uvs[step.x > 0 ? 1 : 2] - mesh.uvs[0];
      EXPECT_LT((parameters.duv_dx - duv).length(), 1e-5f);
    }
    expect_near(s.dpdu * parameters.duv_dx.x + s.dpdv * parameters.duv_dx.y, moved);
    const double h = 1e-5;
    const V3d dn =
        (normal_at(b1 + h * step.x, b2 + h * step.y) - normal_at(b1 - h * step.x, b2 - h * step.y)) / (2 * h);
    expect_near(s.dndu * parameters.duv_dx.x + s.dndv * parameters.duv_dx.y, V3f(dn), 1e-3f);
  }
}

TEST(SurfaceDifferentials, MatchMovedPoints) {
  M44f stretched;
  stretched.setEulerAngles(V3f(0.3f, 1.0f, -0.5f));
  M44f scale;
  scale.setScale(V3f(3.0f, 0.5f, -2.0f));  // mirrored as well
  for (const bool with_uvs : {true, false}) {
    expect_matches_moved_points(triangle(with_uvs), M44f());
    expect_matches_moved_points(triangle(with_uvs), scale * stretched);
  }
}

TEST(SurfaceDifferentials, FallBackToATangentFrame) {
  Mesh mesh = triangle(true);
  mesh.uvs = {V2f(0.5f), V2f(0.5f), V2f(0.5f)};
  const SurfaceDifferentials same = surface_differentials(mesh, 0, 0.3f, 0.3f);
  mesh.uvs = {V2f(0.0f), V2f(0.5f), V2f(1.0f)};
  const SurfaceDifferentials line = surface_differentials(mesh, 0, 0.3f, 0.3f);
  mesh.uvs.clear();
  const SurfaceDifferentials none = surface_differentials(mesh, 0, 0.3f, 0.3f);
  for (const SurfaceDifferentials& s : {same, line, none}) {
    EXPECT_FALSE(s.has_uvs);
    EXPECT_NEAR(s.dpdu.length(), 1.0f, 1e-6f);
    EXPECT_NEAR(s.dpdv.length(), 1.0f, 1e-6f);
    EXPECT_NEAR(s.dpdu.dot(s.dpdv), 0.0f, 1e-6f);
    EXPECT_EQ(s.dndu, none.dndu);
  }
  mesh.normals = {V3f(0, 0, -1), V3f(0, 0, -1), V3f(0, 0, -1)};
  EXPECT_GT(surface_differentials(mesh, 0, 0.3f, 0.3f).normal.z, 0.0f)
      << "normals that point inward are turned";
  mesh.normals.clear();
  EXPECT_EQ(surface_differentials(mesh, 0, 0.3f, 0.3f).dndu, V3f(0.0f));
  for (const float size : {0.0f, 1e-30f, 1e18f}) {
    Mesh odd = triangle(true);
    for (V3f& p : odd.positions) p *= size;
    const SurfaceDifferentials s = surface_differentials(odd, 0, 0.3f, 0.3f);
    EXPECT_TRUE(is_finite(s.dpdu) && is_finite(s.dpdv) && is_finite(s.dndu) && is_finite(s.dndv)) << size;
    EXPECT_GT(s.dpdu.cross(s.dpdv).length() + (size == 1e-30f ? 1.0f : 0.0f), 0.0f) << size;
    EXPECT_NEAR(s.normal.length(), 1.0f, 1e-5f) << size;
  }
}

}  // namespace
}  // namespace becalm::tracer
