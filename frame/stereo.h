#pragma once

#include <Imath/ImathVec.h>

#include <cmath>

namespace becalm {

/// The eye that a view is of; `centre` for cameras with one.
enum class Eye { centre, left, right };

/// A pair of pinhole cameras side by side: both look in the same direction, and their films are shifted so
/// that points at the convergence distance have no disparity (off-axis, or sheared frustums).
struct StereoCamera {
  double focal_px = 0.0;     ///< distance of the film from the eye
  double separation = 0.0;   ///< of the eyes, scene units
  double convergence = 0.0;  ///< distance along the view, scene units

  bool operator==(const StereoCamera&) const = default;

  /// Position of an eye along the camera's right, from the middle of both.
  double eye_position(Eye eye) const {
    return eye == Eye::left ? -0.5 * separation : eye == Eye::right ? 0.5 * separation : 0.0;
  }

  /// How far the axis of an eye's view lies to the right of its image's middle, in pixels.
  double axis_px(Eye eye) const { return focal_px * eye_position(eye) / convergence; }

  /// How far to the right of its place in the right image a point lies in the left one, in pixels. `z` is its
  /// distance along the view, which may be infinite.
  double disparity_px(double z) const { return focal_px * separation * (1.0 / z - 1.0 / convergence); }
};

/// What a stereo frame knows of its camera.
struct StereoView {
  StereoCamera camera;
  Eye eye = Eye::left;
  Imath::V2d middle_px{0.0,
                       0.0};  ///< of the whole picture, from the middle of this image, which may be cropped

  bool operator==(const StereoView&) const = default;

  /// Distance along the view over distance along the ray of a pixel position, in an image of this size.
  double cosine(double x, double y, int width, int height) const {
    const double right = x - 0.5 * width - middle_px.x - camera.axis_px(eye);
    const double down = y - 0.5 * height - middle_px.y;
    return camera.focal_px / std::sqrt(camera.focal_px * camera.focal_px + right * right + down * down);
  }

  /// Where a point appears in the other eye's image, relative to its place in this one, along x in pixels.
  double offset_to_other_px(double z) const {
    return eye == Eye::left ? -camera.disparity_px(z) : camera.disparity_px(z);
  }

  Eye other_eye() const { return eye == Eye::left ? Eye::right : Eye::left; }
};

}  // namespace becalm
