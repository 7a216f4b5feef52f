#include "tracer/camera_animation.h"

namespace becalm::tracer {

Camera camera_at(const CameraSettings& settings, double frame, int width, int height) {
  const LookAt view = look_at(settings.look_at, frame);
  Lens lens;
  lens.aperture_radius = static_cast<float>(settings.aperture_radius.at(frame)[0]);
  lens.focus_distance =
      settings.focus_distance ? settings.focus_distance->at(frame)[0] : (view.target - view.eye).length();
  lens.blades = settings.blades;
  lens.blade_rotation = static_cast<float>(settings.blade_rotation_deg * std::numbers::pi / 180.0);
  return Camera(view, settings.fov_y_deg, width, height, lens);
}

}  // namespace becalm::tracer
