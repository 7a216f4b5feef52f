#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tracer/lights/area_light.h"
#include "tracer/lights/environment.h"
#include "tracer/sampling/discrete_distribution.h"
#include "tracer/vec.h"

namespace becalm::tracer {

/// All emitters of a frame. Chosen by power; triangles without area or radiance are never chosen.
class Lights {
 public:
  Lights() = default;
  /// `scene_radius` is that of a sphere around the scene: the environment's power is what would cross its
  /// disc. 0 when unknown: then environment and triangles get half of the samples each. Where both exist
  /// neither gets less than a tenth.
  Lights(std::vector<EmissiveTriangle> triangles, std::optional<Environment> environment,
         float scene_radius = 0.0f);

  /// Whether there is nothing to sample.
  bool empty() const { return choice_.empty(); }

  /// Direction from `point` to a light. Nothing when the chosen light cannot shine on the point (behind a
  /// one-sided triangle, edge-on): this is part of the estimate, do not draw again.
  std::optional<LightSample> sample(const V3f& point, float u_light, const V2f& u) const;

  /// Density per solid angle with which sample() finds triangle number `triangle` (of the constructor's list)
  /// in this direction at this distance; 0 where sample() gives nothing.
  float pdf_triangle(std::size_t triangle, const V3f& point, const V3f& dir_world, float distance) const;
  float pdf_environment(const V3f& dir_world) const;

  /// Zero without an environment.
  V3f environment_radiance(const V3f& dir_world) const;

 private:
  std::vector<AreaLight> area_lights_;
  std::optional<Environment> environment_;
  DiscreteDistribution choice_;  ///< the triangles, then the environment if there is one
};

}  // namespace becalm::tracer
