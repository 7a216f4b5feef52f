#pragma once

#include <numbers>
#include <optional>

#include "frame/stereo.h"
#include "tracer/scene/transform.h"
#include "tracer/snapshot/intersect.h"

namespace becalm::tracer {

/// A thin lens: points at the focus distance are sharp, others spread over their circle of confusion.
struct Lens {
  float aperture_radius = 0.0f;  ///< scene units; 0: a pinhole
  double focus_distance = 1.0;   ///< along the view, scene units
  int blades = 0;                ///< sides of the aperture; less than 3: a disc
  float blade_rotation = 0.0f;   ///< radians, of the first corner from the right, counter-clockwise
};

/// A point uniform over the aperture, in units of its radius: the unit disc, or the regular polygon whose
/// corners lie on the unit circle. Source of the disc's map: Shirley and Chiu, "A Low Distortion Map Between
/// Disk and Square", 1997.
V2f sample_aperture(int blades, float rotation, const V2f& u);

/// Camera over a film of that size, in double so that motion between frames is exact to well below 1e-3 px.
/// Raster positions are in pixels from the top left, pixel centres at integer + 0.5.
class Camera {
 public:
  Camera(const LookAt& look_at, double fov_y_deg, int width, int height, const Lens& lens = {})
      : eye_(look_at.eye),
        forward_((look_at.target - look_at.eye).normalized()),
        right_(forward_.cross(look_at.up).normalized()),
        up_(right_.cross(forward_)),
        center_(0.5 * width, 0.5 * height),
        focal_px_(0.5 * height / std::tan(0.5 * fov_y_deg * std::numbers::pi / 180.0)),
        lens_(lens) {}

  /// One eye of a pair around this camera.
  Camera of_eye(Eye eye, double separation, double convergence) const {
    const StereoCamera pair{.focal_px = focal_px_, .separation = separation, .convergence = convergence};
    Camera camera = *this;
    camera.eye_ += right_ * pair.eye_position(eye);
    camera.center_.x += pair.axis_px(eye);
    return camera;
  }

  /// Through the pinhole.
  Ray ray(const V2f& raster) const { return {V3f(eye_), V3f(direction(raster).normalized())}; }

  /// Through the point of the lens that u in [0,1)^2 chooses, to where the pinhole's ray is in focus.
  Ray ray(const V2f& raster, const V2f& u) const {
    const V2f point = sample_aperture(lens_.blades, lens_.blade_rotation, u) * lens_.aperture_radius;
    const V3d from_eye = right_ * static_cast<double>(point.x) + up_ * static_cast<double>(point.y);
    const V3d focus = direction(raster) * (lens_.focus_distance / focal_px_);
    return {V3f(eye_ + from_eye), V3f((focus - from_eye).normalized())};
  }

  /// Direction, not normalised, of the pinhole's ray; its change over a pixel to the right and down.
  V3d direction(const V2f& raster) const {
    return forward_ * focal_px_ + right_ * (raster.x - center_.x) + up_ * (center_.y - raster.y);
  }
  V3f eye() const { return V3f(eye_); }
  const V3d& right() const { return right_; }
  V3d down() const { return -up_; }
  double focal_px() const { return focal_px_; }

  /// Where the point appears through the pinhole; nothing behind the camera.
  std::optional<V2d> project(const V3d& point_world) const { return project_direction(point_world - eye_); }
  /// The same of a point infinitely far in that direction.
  std::optional<V2d> project_direction(const V3d& dir_world) const {
    const double depth = dir_world.dot(forward_);
    if (!(depth > 0.0)) return std::nullopt;
    return V2d(center_.x + focal_px_ * dir_world.dot(right_) / depth,
               center_.y - focal_px_ * dir_world.dot(up_) / depth);
  }

 private:
  V3d eye_, forward_, right_, up_;
  V2d center_;       ///< where the axis of the view meets the film
  double focal_px_;  ///< distance of the film from the eye
  Lens lens_;
};

}  // namespace becalm::tracer
