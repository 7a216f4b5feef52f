#include "tracer/scene/load/load_sections.h"

namespace becalm::tracer {

namespace {

LookAtCurve::Value read_look_at_value(const JsonValue& json) {
  LookAtCurve::Value value;
  const auto eye = json.at("eye").numbers<3>(-kLargestCoordinate, kLargestCoordinate);
  const auto target = json.at("target").numbers<3>(-kLargestCoordinate, kLargestCoordinate);
  const auto up = json.has("up") ? json.at("up").numbers<3>() : std::array<double, 3>{0, 1, 0};
  std::copy(eye.begin(), eye.end(), value.begin());
  std::copy(target.begin(), target.end(), value.begin() + 3);
  std::copy(up.begin(), up.end(), value.begin() + 6);
  if (!is_valid(look_at(value, 0.0)))
    json.fail("eye and target must differ, and up must not point along the view");
  return value;
}

}  // namespace

CameraSettings read_camera(const JsonValue& json) {
  json.allow_keys({"fov_y_deg", "look_at", "shutter", "aperture_radius", "focus_distance", "eye_separation",
                   "convergence_distance", "blades", "blade_rotation_deg"});
  CameraSettings camera;
  if (const auto fov = json.find("fov_y_deg")) camera.fov_y_deg = fov->number(0.01, 179.0);
  const JsonValue view = json.at("look_at");
  if (view.has("keys")) {
    camera.look_at = read_keys<9>(view, [](const JsonValue& key) {
      key.allow_keys({"frame", "eye", "target", "up"});
      return read_look_at_value(key);
    });
  } else {
    view.allow_keys({"eye", "target", "up"});
    camera.look_at = read_look_at_value(view);
  }
  if (const auto shutter = json.find("shutter")) {
    const auto interval = shutter->numbers<2>(-1000.0, 1000.0);
    if (interval[1] < interval[0]) shutter->fail("expected [open, close] with open <= close");
    camera.shutter = {interval[0], interval[1]};
  }
  if (const auto v = json.find("aperture_radius"))
    camera.aperture_radius = read_number_curve(*v, 0.0, kLargestCoordinate);
  if (const auto v = json.find("focus_distance"))
    camera.focus_distance = read_number_curve(*v, std::numeric_limits<float>::min(), kLargestNumber);
  if (const auto v = json.find("eye_separation"))
    camera.eye_separation = read_number_curve(*v, 0.0, kLargestCoordinate);
  if (const auto v = json.find("convergence_distance")) {
    if (!camera.has_two_eyes()) v->fail("is of cameras with an eye_separation");
    camera.convergence_distance = read_number_curve(*v, std::numeric_limits<float>::min(), kLargestNumber);
  }
  if (const auto v = json.find("blades")) {
    camera.blades = v->integer(0, 64);
    if (camera.blades == 1 || camera.blades == 2) v->fail("expected 0 for a disc, or 3 to 64 sides");
  }
  if (const auto v = json.find("blade_rotation_deg")) camera.blade_rotation_deg = v->number();
  return camera;
}

}  // namespace becalm::tracer
