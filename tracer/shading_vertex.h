#pragma once

#include "tracer/lights/receiver.h"
#include "tracer/materials/bsdf.h"
#include "tracer/math/shading_frame.h"
#include "tracer/snapshot/surface.h"

namespace becalm::tracer {

/// The shading normal, turned as far towards `wo` as needed for both normals to see `wo` on the same side.
/// Near the silhouettes of smooth meshes the interpolated normal may face away.
inline V3f visible_normal(const Surface& surface, const V3f& wo) {
  const V3f& ns = surface.normal_shading;
  const float side = wo.dot(surface.normal_geometric) < 0.0f ? -1.0f : 1.0f;
  constexpr float least_cos = 0.01f;
  const float cos_wo = side * ns.dot(wo);
  if (cos_wo >= least_cos || side * wo.dot(surface.normal_geometric) < least_cos)
    return cos_wo > 0.0f ? ns : surface.normal_geometric;
  return (ns + wo * (side * (least_cos - cos_wo))).normalized();
}

/// The point of a surface that a path scatters at.
struct ShadingVertex {
  const Surface& surface;
  const Bsdf& bsdf;
  ShadingFrame frame;
  V3f wo_world;
  V3f wo;  ///< local

  ShadingVertex(const Surface& at, const Bsdf& material, const ShadingFrame& local, const V3f& to_eye_world)
      : surface(at), bsdf(material), frame(local), wo_world(to_eye_world), wo(local.to_local(to_eye_world)) {}

  /// The vertex as light sampling sees it.
  Receiver receiver() const {
    if (transmits(bsdf)) return surface.position;
    return {surface.position, wo.z < 0.0f ? -frame.normal : frame.normal};
  }

  /// Whether the shading and the geometric normal agree on the side of wi; light that would leak through is
  /// dropped.
  bool consistent(const V3f& wi, const V3f& wi_world) const {
    const float geometric = wi_world.dot(surface.normal_geometric) * wo_world.dot(surface.normal_geometric);
    return geometric * (wi.z * wo.z) > 0.0f;
  }
};

}  // namespace becalm::tracer
