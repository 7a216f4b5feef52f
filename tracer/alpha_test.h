#pragma once

#include "tracer/sampling/sobol.h"
#include "tracer/scene/mesh.h"
#include "tracer/scene/scene.h"

namespace becalm::tracer {

/// Whether rays may pass through surfaces of this material.
inline bool has_opacity(const Material&) { return false; }

inline float alpha_random(std::uint32_t seed, std::uint32_t geometry, std::uint32_t triangle) {
  return to_unit_float(seed ^ geometry ^ triangle);
}

inline bool alpha_test(const Material&, const Mesh&, std::uint32_t, float, float, float) { return true; }

}  // namespace becalm::tracer
