#pragma once

#include <cmath>

#include "tracer/vec.h"

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

  V3f to_local(const V3f& world) const {
    return {world.dot(tangent), world.dot(bitangent), world.dot(normal)};
  }
  V3f to_world(const V3f& local) const { return tangent * local.x + bitangent * local.y + normal * local.z; }
};

}  // namespace becalm::tracer
