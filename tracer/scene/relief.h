#pragma once

#include "tracer/scene/material.h"

namespace becalm::tracer {

/// Where the relief of a surface is looked up; all in one space, world space by choice of BumpMap::scale.
struct ReliefPoint {
  TexturePoint texture;
  V3f dpdu, dpdv;        ///< of the surface; need not be perpendicular to the normal or to each other
  V3f normal_shading;    ///< unit
  V3f normal_geometric;  ///< unit; the shading normal is in its hemisphere
};

/// The shading normal of a material with a normal map, a bump map, or both (the bumps on the map's normals).
/// Unit length, in the hemisphere of the geometric normal: a normal that the relief turns beyond it is
/// brought back to just above the horizon. The shading normal itself where dpdu and dpdv are zero, parallel
/// or not finite, and for materials without either map.
///
/// Bumps: n - grad h with the surface gradient of Mikkelsen, "Bump Mapping Unparametrized Surfaces on the
/// GPU", 2010, which is Blinn's (1978) displaced normal to first order. Heights are differenced over the
/// footprint, and at least over a texel, so that MIP levels and steps fit together.
V3f perturbed_normal(const Material& material, const Textures::Reader& textures, const ReliefPoint& point);

}  // namespace becalm::tracer
