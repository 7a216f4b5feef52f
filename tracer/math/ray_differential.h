#pragma once

#include <algorithm>
#include <cmath>

#include "tracer/math/shading_frame.h"
#include "tracer/math/vec.h"

namespace becalm::tracer {

// Ray differentials: Igehy, "Tracing Ray Differentials", 1999. x and y are the picture's, in pixels; a
// sample's share of a pixel is taken out by footprint_scale (scene/texture.h), which multiplies all four
// vectors.

/// How a ray changes from one pixel to the next: of its origin, and of its unit direction.
struct RayDifferential {
  V3f dpdx{0.0f}, dpdy{0.0f};
  V3f dddx{0.0f}, dddy{0.0f};
};

/// Derivative of v / |v| where v changes by dv (eq. 8); zero for v = 0.
inline V3f unit_derivative(const V3f& v, const V3f& dv) {
  const double length2 = V3d(v).dot(V3d(v));
  if (!(length2 > 0.0)) return V3f(0.0f);
  const V3d along = V3d(v) * (V3d(v).dot(V3d(dv)) / length2);
  return V3f((V3d(dv) - along) / std::sqrt(length2));
}

inline RayDifferential operator*(const RayDifferential& ray, float factor) {
  return {ray.dpdx * factor, ray.dpdy * factor, ray.dddx * factor, ray.dddy * factor};
}

/// Footprints on a surface seen at a smaller cosine than this are as long as at this one: beyond a stretch of
/// 1000 they only lose precision.
inline constexpr float kLeastFootprintCos = 1e-3f;

/// At a hit, t along the unit direction `dir`, on the plane with that normal (eq. 10 and 12): dpdx and dpdy
/// lie in the plane, dddx and dddy stay. The geometric normal; its side does not matter.
inline RayDifferential transferred(const RayDifferential& ray, const V3f& dir, float t, const V3f& normal) {
  const float cosine = dir.dot(normal);
  const float divisor = std::copysign(std::max(std::abs(cosine), kLeastFootprintCos), cosine);
  const auto onto_plane = [&](const V3f& dp, const V3f& dd) {
    const V3f moved = dp + dd * t;
    return moved - dir * (moved.dot(normal) / divisor);
  };
  return {onto_plane(ray.dpdx, ray.dddx), onto_plane(ray.dpdy, ray.dddy), ray.dddx, ray.dddy};
}

/// Of the ray that a mirror sends on (eq. 15 to 17): `ray` at the hit, its direction, the unit shading
/// normal, of either side, and how that changes with x and y.
inline RayDifferential reflected(const RayDifferential& ray, const V3f& dir, const V3f& normal,
                                 const V3f& dndx, const V3f& dndy) {
  const auto turned = [&](const V3f& dd, const V3f& dn) {
    const float dcos = dd.dot(normal) + dir.dot(dn);
    return dd - (dn * dir.dot(normal) + normal * dcos) * 2.0f;
  };
  return {ray.dpdx, ray.dpdy, turned(ray.dddx, dndx), turned(ray.dddy, dndy)};
}

/// Of the ray that a smooth interface refracts (eq. 18 and 19). `eta` is the index of refraction on the side
/// of `dir`'s origin over that across. Unchanged directions where all is reflected.
inline RayDifferential refracted(const RayDifferential& ray, const V3f& dir, const V3f& normal,
                                 const V3f& dndx, const V3f& dndy, float eta) {
  const float side = dir.dot(normal) > 0.0f ? -1.0f : 1.0f;  // the equations' normal faces the ray
  const float cos_i = side * dir.dot(normal);                // negative
  const float cos2_t = 1.0f - eta * eta * (1.0f - cos_i * cos_i);
  if (!(cos2_t > 0.0f)) return ray;
  const float cos_t = -std::sqrt(cos2_t);
  const float mu = eta * cos_i - cos_t;
  // At the critical angle the change is infinite; the footprint's limit serves here too.
  const float dmu_dcos = eta - eta * eta * cos_i / std::min(cos_t, -kLeastFootprintCos);
  const auto bent = [&](const V3f& dd, const V3f& dn) {
    const float dcos = side * (dd.dot(normal) + dir.dot(dn));
    return dd * eta - (dn * mu + normal * (dmu_dcos * dcos)) * side;
  };
  return {ray.dpdx, ray.dpdy, bent(ray.dddx, dndx), bent(ray.dddy, dndy)};
}

/// Of a ray that left a rough surface in direction `dir`: at least `spread` radians between neighbours, about
/// the spacing of the few directions that a pixel sends into the hemisphere.
inline RayDifferential scattered(const RayDifferential& ray, const V3f& dir, float spread) {
  const float angle = std::max({spread, ray.dddx.length(), ray.dddy.length()});
  const ShadingFrame frame = ShadingFrame::from_normal(dir);
  return {ray.dpdx, ray.dpdy, frame.tangent * angle, frame.bitangent * angle};
}

/// How a surface's parameters change with x and y.
struct ParameterFootprint {
  V2f duv_dx{0.0f};
  V2f duv_dy{0.0f};
};

/// The parameters whose change moves the point by dpdx and dpdy, in the least squares' sense (with
/// `transferred` exactly). Zero where dpdu and dpdv span no surface or the numbers have no finite answer:
/// then the finest level is read, which may alias but converges.
inline ParameterFootprint parameter_footprint(const V3f& dpdx, const V3f& dpdy, const V3f& dpdu,
                                              const V3f& dpdv) {
  const V3d u(dpdu), v(dpdv);
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v);
  const double determinant = uu * vv - uv * uv;
  constexpr double least_sine2 = 1e-12;  // of the angle between dpdu and dpdv
  if (!(determinant > least_sine2 * uu * vv)) return {};
  const double inverse = 1.0 / determinant;
  const auto solve = [&](const V3f& dp) {
    const double pu = V3d(dp).dot(u), pv = V3d(dp).dot(v);
    const V2f duv(static_cast<float>((vv * pu - uv * pv) * inverse),
                  static_cast<float>((uu * pv - uv * pu) * inverse));
    return std::isfinite(duv.x) && std::isfinite(duv.y) ? duv : V2f(0.0f);
  };
  return {solve(dpdx), solve(dpdy)};
}

}  // namespace becalm::tracer
