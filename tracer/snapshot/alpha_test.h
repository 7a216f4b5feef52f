#pragma once

#include "tracer/sampling/sobol.h"
#include "tracer/scene/material.h"
#include "tracer/scene/mesh.h"

namespace becalm::tracer {

/// A number in [0,1) that depends on the ray and the triangle alone: hierarchies with spatial splits may test
/// one hit several times.
inline float alpha_random(std::uint32_t ray_seed, std::uint32_t geometry, std::uint32_t triangle) {
  const std::uint64_t bits =
      mix_bits((std::uint64_t{ray_seed} << 32 | triangle) ^ (std::uint64_t{geometry} << 16));
  return to_unit_float(static_cast<std::uint32_t>(bits >> 32));
}

/// Whether a ray meets the triangle at these barycentrics: true with the probability of the opacity there, so
/// that the light that passes is right on average.
inline bool alpha_test(const Material& material, const Mesh& mesh, std::uint32_t triangle, float u, float v,
                       float random) {
  V2f uv(0.0f);
  if (!mesh.uvs.empty()) {
    const auto& corners = mesh.triangles[triangle];
    uv = mesh.uvs[corners[0]] * (1.0f - u - v) + mesh.uvs[corners[1]] * u + mesh.uvs[corners[2]] * v;
  }
  return random < opacity(material, uv);
}

}  // namespace becalm::tracer
