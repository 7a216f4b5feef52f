#pragma once

#include <cmath>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Right-handed orthonormal frame whose z axis is `normal`: where the BSDFs live.
struct ShadingFrame {
  V3f tangent;
  V3f bitangent;
  V3f normal;

  /// `unit_normal` of length 1. Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1),
  /// 2017.
  static ShadingFrame from_normal(const V3f& unit_normal) {
    const V3f& n = unit_normal;
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
  }

  /// With the tangent along the part of `along` that is perpendicular to the normal: what anisotropic lobes
  /// follow. from_normal's where `along` has no such part.
  static ShadingFrame from_normal_and_tangent(const V3f& unit_normal, const V3f& along) {
    const V3d n(unit_normal), a(along);  // lengths of 1e30 must have squares
    const V3d tangent = a - n * n.dot(a);
    const double length2 = tangent.dot(tangent);
    constexpr double least_sine2 = 1e-10;
    if (!(length2 > least_sine2 * a.dot(a)) || !std::isfinite(length2)) return from_normal(unit_normal);
    const V3f unit(tangent / std::sqrt(length2));
    return {unit, unit_normal.cross(unit), unit_normal};
  }

  V3f to_local(const V3f& world) const {
    return {world.dot(tangent), world.dot(bitangent), world.dot(normal)};
  }
  V3f to_world(const V3f& local) const { return tangent * local.x + bitangent * local.y + normal * local.z; }
};

}  // namespace becalm::tracer
