#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "tracer/lights/light_bounds.h"
#include "tracer/lights/light_list.h"
#include "tracer/lights/rectangles.h"

namespace becalm::tracer {

/// The emitters within the scene, numbered: areas, spheres, points, spots. An area is a triangle, or two of
/// the list that make a rectangle. `time` is the position in the shutter interval, in [0,1].
class Emitters {
 public:
  Emitters() = default;
  /// Empties the list of what it takes.
  explicit Emitters(LightList& list);

  std::size_t count() const { return first_spot() + spots_.size(); }
  std::size_t of_triangle(std::size_t triangle) const { return area_of_triangle_[triangle]; }
  std::size_t of_sphere(std::size_t sphere) const { return first_sphere() + sphere; }

  /// In the strongest direction, mean over the channels and the shutter interval. 0 for those that cannot be
  /// sampled: without size or power, or with values that are not finite.
  double radiant_intensity(std::size_t number) const;

  /// Of one that can be sampled. Those of moving emitters face everywhere.
  LightBounds bounds(std::size_t number) const;

  /// What arrives at the receiver if nothing is in between, as irradiance.h has it.
  double irradiance_at(std::size_t number, const Receiver& at, float time) const;
  /// Whether that is not 0.
  bool reaches(std::size_t number, const Receiver& at, float time) const;

  std::optional<LightSample> sample(std::size_t number, const Receiver& at, float time, const V2f& u) const;
  float pdf_area(std::size_t number, const Receiver& at, const V3f& dir_world, float distance,
                 float time) const;
  float pdf_sphere(std::size_t sphere, const Receiver& at, float time) const;

 private:
  std::size_t first_sphere() const { return areas_.size(); }
  std::size_t first_point() const { return first_sphere() + spheres_.size(); }
  std::size_t first_spot() const { return first_point() + points_.size(); }

  /// Calls f with the emitter at that time.
  template <class F>
  auto visit(std::size_t number, float time, const F& f) const {
    if (number < first_sphere()) return moving_area(number) ? f(area_at(number, time)) : f(areas_[number]);
    if (number < first_point()) return f(sphere_at(spheres_[number - first_sphere()], time));
    if (number < first_spot()) return f(point_at(points_[number - first_point()], time));
    return f(spot_at(spots_[number - first_spot()], time));
  }
  bool moving_area(std::size_t number) const {
    return !area_motion_.empty() && area_motion_[number].moving();
  }
  MotionKeys motion(std::size_t number) const;

  AreaLight area_at(std::size_t number, float time) const;
  EmissiveSphere sphere_at(const EmissiveSphere& sphere, float time) const;
  PointLight point_at(const PointLight& point, float time) const;
  SpotEmitter spot_at(const SpotEmitter& spot, float time) const;

  std::vector<AreaLight> areas_;
  std::vector<EmissiveSphere> spheres_;
  std::vector<PointLight> points_;
  std::vector<SpotEmitter> spots_;
  std::vector<std::uint32_t> area_of_triangle_;

  // Of each area; none if none moves.
  std::vector<MotionKeys> area_motion_;
  std::vector<TriangleOrRectangle> area_corners_;

  std::vector<TriangleKey> triangle_keys_;
  std::vector<SphereKey> sphere_keys_;
  std::vector<V3f> point_keys_;
  std::vector<SpotKey> spot_keys_;
};

}  // namespace becalm::tracer
