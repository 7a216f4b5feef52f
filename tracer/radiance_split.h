#pragma once

#include <cstdint>
#include <vector>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// The parts of one path's radiance: each adds up to the whole.
struct RadianceSplit {
  V3f direct{0.0f};         ///< light that scattered at most once, perfect mirrors and glass not counted
  V3f indirect{0.0f};       ///< all other light
  std::vector<V3f> groups;  ///< for each light group of the scene

  explicit RadianceSplit(std::size_t group_count) : groups(group_count, V3f(0.0f)) {}

  void clear() {
    direct = indirect = V3f(0.0f);
    std::fill(groups.begin(), groups.end(), V3f(0.0f));
  }
  void add(const V3f& radiance, int scatterings, std::uint16_t group) {
    (scatterings <= 1 ? direct : indirect) += radiance;
    groups[group] += radiance;
  }
};

}  // namespace becalm::tracer
