#include "tracer/camera_animation.h"

namespace becalm::tracer {

namespace {

double focus_distance_at(const CameraSettings& settings, const LookAt& view, double frame) {
  return settings.focus_distance ? settings.focus_distance->at(frame)[0] : (view.target - view.eye).length();
}

double convergence_at(const CameraSettings& settings, const LookAt& view, double frame) {
  return settings.convergence_distance ? settings.convergence_distance->at(frame)[0]
                                       : focus_distance_at(settings, view, frame);
}

}  // namespace

Camera camera_at(const CameraSettings& settings, double frame, int width, int height, Eye eye) {
  const LookAt view = look_at(settings.look_at, frame);
  Lens lens;
  lens.aperture_radius = static_cast<float>(settings.aperture_radius.at(frame)[0]);
  lens.focus_distance = focus_distance_at(settings, view, frame);
  lens.blades = settings.blades;
  lens.blade_rotation = static_cast<float>(settings.blade_rotation_deg * std::numbers::pi / 180.0);
  const Camera camera(view, settings.fov_y_deg, width, height, lens);
  if (eye == Eye::centre || !settings.eye_separation) return camera;
  return camera.of_eye(eye, settings.eye_separation->at(frame)[0], convergence_at(settings, view, frame));
}

std::optional<StereoCamera> stereo_camera_at(const CameraSettings& settings, double frame, int width,
                                             int height) {
  if (!settings.eye_separation) return std::nullopt;
  const LookAt view = look_at(settings.look_at, frame);
  return StereoCamera{.focal_px = Camera(view, settings.fov_y_deg, width, height).focal_px(),
                      .separation = settings.eye_separation->at(frame)[0],
                      .convergence = convergence_at(settings, view, frame)};
}

}  // namespace becalm::tracer
