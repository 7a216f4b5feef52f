#pragma once

#include <numbers>
#include <optional>

#include "tracer/intersect.h"
#include "tracer/scene/transform.h"

namespace becalm::tracer {

/// Pinhole camera over a film of that size, in double so that motion between frames is exact to well below
/// 1e-3 px. Raster positions are in pixels from the top left, pixel centres at integer + 0.5.
class Camera {
 public:
  Camera(const LookAt& look_at, double fov_y_deg, int width, int height)
      : eye_(look_at.eye),
        forward_((look_at.target - look_at.eye).normalized()),
        right_(forward_.cross(look_at.up).normalized()),
        up_(right_.cross(forward_)),
        center_(0.5 * width, 0.5 * height),
        focal_px_(0.5 * height / std::tan(0.5 * fov_y_deg * std::numbers::pi / 180.0)) {}

  Ray ray(const V2f& raster) const {
    const V3d dir = forward_ * focal_px_ + right_ * (raster.x - center_.x) + up_ * (center_.y - raster.y);
    return {V3f(eye_), V3f(dir.normalized())};
  }

  /// Where the point appears; nothing behind the camera.
  std::optional<V2d> project(const V3d& point_world) const { return project_direction(point_world - eye_); }
  /// The same of a point infinitely far in that direction.
  std::optional<V2d> project_direction(const V3d& dir_world) const {
    const double depth = dir_world.dot(forward_);
    if (!(depth > 0.0)) return std::nullopt;
    return V2d(center_.x + focal_px_ * dir_world.dot(right_) / depth,
               center_.y - focal_px_ * dir_world.dot(up_) / depth);
  }

  /// Angle between the rays of neighbouring pixels in the middle of the film, in radians.
  double pixel_angle() const { return 1.0 / focal_px_; }

 private:
  V3d eye_, forward_, right_, up_;
  V2d center_;
  double focal_px_;  ///< distance of the film from the eye
};

}  // namespace becalm::tracer
