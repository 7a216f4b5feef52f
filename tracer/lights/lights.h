#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "tracer/lights/area_light.h"
#include "tracer/lights/environment.h"
#include "tracer/lights/light_tree.h"
#include "tracer/lights/point_light.h"
#include "tracer/lights/sphere_light.h"
#include "tracer/lights/spot_light.h"
#include "tracer/lights/sun_light.h"
#include "tracer/math/vec.h"
#include "tracer/sampling/discrete_distribution.h"

namespace becalm::tracer {

/// What shines in a frame. Emitters that move during the shutter interval refer to the arrays of keys.
struct LightList {
  std::vector<EmissiveTriangle> triangles;
  std::vector<EmissiveSphere> spheres;
  std::vector<PointLight> points;
  std::vector<SpotLight> spots;
  std::vector<SunLight> suns;
  std::optional<Environment> environment;
  std::uint16_t environment_group = 0;
  /// Of a sphere around the scene: the power of light from infinity is what would cross its disc. 0 when
  /// unknown.
  float scene_radius = 0.0f;

  std::vector<TriangleKey> triangle_keys;
  std::vector<SphereKey> sphere_keys;
  std::vector<V3f> point_keys;
  std::vector<SpotKey> spot_keys;
};

/// All emitters of a frame. Chosen by power, that of moving ones on average over the shutter interval, and
/// where many are within the scene by what they may send to the point (see LightTree). Emitters without size,
/// without power or with values that are not finite are never chosen. Light from within the scene, from suns
/// and from the environment each take at least a tenth of the samples where they exist, and equal parts where
/// the scene's radius is unknown. `time` is the position in the shutter interval, in [0,1].
class Lights {
 public:
  Lights() = default;
  explicit Lights(LightList list);

  /// Whether there is nothing to sample.
  bool empty() const { return choice_.empty(); }

  /// Direction from `point` to a light. Nothing when the chosen light cannot shine on the point (behind a
  /// one-sided triangle, edge-on, outside a spot's cone): this is part of the estimate, do not draw again.
  std::optional<LightSample> sample(const V3f& point, float time, float u_light, const V2f& u) const;

  /// Density per solid angle with which sample() finds triangle number `triangle` (of the list) in this
  /// direction at this distance; 0 where sample() gives nothing.
  float pdf_triangle(std::size_t triangle, const V3f& point, const V3f& dir_world, float distance,
                     float time) const;

  /// The same for sphere number `sphere`, in any direction in which it is seen from the point.
  float pdf_sphere(std::size_t sphere, const V3f& point, float time) const;

  /// Calls f(radiance, pdf_solid_angle, group) for each light from infinity that a ray in the unit direction
  /// runs into: the environment, and suns whose disc contains it. The density is that of sample().
  template <class F>
  void for_each_infinite(const V3f& dir_world, const F& f) const {
    if (environment_) {
      const Environment::Lookup seen = environment_->look_up(dir_world);
      const float chosen = choice_.probability(first_infinite_ + suns_.size());
      f(seen.radiance, seen.pdf_solid_angle * chosen, environment_group_);
    }
    for (std::size_t i = 0; i < suns_.size(); ++i) {
      const SunEmitter& sun = suns_[i];
      if (sun.contains(dir_world)) {
        f(sun.radiance, sun.pdf_solid_angle() * choice_.probability(first_infinite_ + i), sun.group);
      }
    }
  }

 private:
  // Emitters are numbered in the order of LightList: triangles, spheres, points, spots, suns, environment.
  std::size_t first_sphere() const { return triangles_.size(); }
  std::size_t first_point() const { return first_sphere() + spheres_.size(); }
  std::size_t first_spot() const { return first_point() + points_.size(); }
  std::size_t first_sun() const { return first_spot() + spots_.size(); }

  std::optional<LightSample> sample_emitter(std::size_t number, const V3f& point, float time,
                                            const V2f& u) const;
  bool moving(std::size_t triangle) const {
    return !triangle_motion_.empty() && triangle_motion_[triangle].moving();
  }
  AreaLight triangle_at(std::size_t triangle, float time) const;
  EmissiveSphere sphere_at(const EmissiveSphere& sphere, float time) const;
  PointLight point_at(const PointLight& point, float time) const;
  SpotEmitter spot_at(const SpotEmitter& spot, float time) const;
  std::vector<double> finite_powers() const;
  std::vector<LightBounds> finite_bounds(std::span<const double> powers) const;
  /// Of choosing a light within the scene.
  float probability(std::size_t number, const V3f& point) const {
    return tree_.empty() ? choice_.probability(number)
                         : choice_.probability(0) * tree_.probability(number, point);
  }

  std::vector<AreaLight> triangles_;
  std::vector<EmissiveSphere> spheres_;
  std::vector<PointLight> points_;
  std::vector<SpotEmitter> spots_;
  std::vector<SunEmitter> suns_;
  std::optional<Environment> environment_;
  std::uint16_t environment_group_ = 0;

  std::vector<MotionKeys> triangle_motion_;  ///< one a triangle; none if no triangle moves
  std::vector<TriangleKey> triangle_keys_;
  std::vector<SphereKey> sphere_keys_;
  std::vector<V3f> point_keys_;
  std::vector<SpotKey> spot_keys_;

  LightTree tree_;  ///< of the lights within the scene, if they are many
  /// Each emitter by its number; with a tree, all of the tree as the first entry, then suns and environment.
  DiscreteDistribution choice_;
  std::size_t first_infinite_ = 0;  ///< entry of the first sun
};

}  // namespace becalm::tracer
