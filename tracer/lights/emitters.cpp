#include "tracer/lights/emitters.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace becalm::tracer {

namespace {

bool finite_place(const AreaLight& light) {
  return light.area > 0.0;
}
bool finite_place(const EmissiveSphere& sphere) {
  return is_finite(sphere.center);
}
bool finite_place(const PointLight& point) {
  return is_finite(point.position);
}
bool finite_place(const SpotEmitter& spot) {
  return is_finite(spot.position);
}

void extend(LightBounds& bounds, const AreaLight& light) {
  const V3d p0(light.p0), e1(light.edge1), e2(light.edge2);
  for (const V3d& corner : {p0, p0 + e1, p0 + e2}) bounds.box.extendBy(corner);
  if (light.quad) bounds.box.extendBy(p0 + e1 + e2);
}
void extend(LightBounds& bounds, const EmissiveSphere& sphere) {
  bounds.box.extendBy(V3d(sphere.center) - V3d(sphere.radius));
  bounds.box.extendBy(V3d(sphere.center) + V3d(sphere.radius));
}
void extend(LightBounds& bounds, const PointLight& point) {
  bounds.box.extendBy(V3d(point.position));
}
void extend(LightBounds& bounds, const SpotEmitter& spot) {
  bounds.box.extendBy(V3d(spot.position));
}

/// The directions in which an emitter that stands still shines.
void face(LightBounds& bounds, const AreaLight& light) {
  bounds.facing = {V3d(light.normal), 0.0};
}
void face(LightBounds& bounds, const SpotEmitter& spot) {
  bounds.facing = {spot.axis, 0.0};
}
void face(LightBounds&, const EmissiveSphere&) {}
void face(LightBounds&, const PointLight&) {}

/// What holds of an emitter that moves as well.
void spread(LightBounds& bounds, const AreaLight& light) {
  bounds.two_sided = light.two_sided;
}
void spread(LightBounds& bounds, const SpotEmitter& spot) {
  bounds.emission_rad = std::acos(1.0 - spot.outer);
}
void spread(LightBounds&, const EmissiveSphere&) {}
void spread(LightBounds&, const PointLight&) {}

}  // namespace

Emitters::Emitters(LightList& list)
    : spheres_(std::move(list.spheres)),
      points_(std::move(list.points)),
      spots_(list.spots.begin(), list.spots.end()),
      triangle_keys_(std::move(list.triangle_keys)),
      sphere_keys_(std::move(list.sphere_keys)),
      point_keys_(std::move(list.point_keys)),
      spot_keys_(std::move(list.spot_keys)) {
  const bool moving =
      std::ranges::any_of(list.triangles, [](const EmissiveTriangle& t) { return t.motion.moving(); });
  std::vector<TriangleOrRectangle> shapes = find_rectangles(list.triangles, triangle_keys_);
  areas_.reserve(shapes.size());
  area_of_triangle_.reserve(list.triangles.size());
  for (const TriangleOrRectangle& shape : shapes) {
    const EmissiveTriangle& t = list.triangles[shape.triangle];
    area_of_triangle_.insert(area_of_triangle_.end(), shape.rectangle ? 2 : 1,
                             static_cast<std::uint32_t>(areas_.size()));
    areas_.emplace_back(shape.shape({t.p0, t.p1, t.p2}), t.radiance, t.two_sided, t.group, t.extent);
    if (moving) area_motion_.push_back(t.motion);
  }
  if (moving) area_corners_ = std::move(shapes);
  list.triangles.clear();
}

MotionKeys Emitters::motion(std::size_t number) const {
  if (number < first_sphere()) return area_motion_.empty() ? MotionKeys{} : area_motion_[number];
  if (number < first_point()) return spheres_[number - first_sphere()].motion;
  if (number < first_spot()) return points_[number - first_point()].motion;
  return spots_[number - first_spot()].motion;
}

double Emitters::radiant_intensity(std::size_t number) const {
  const auto at = [&](float time) {
    return visit(number, time, [](const auto& emitter) {
      return finite_place(emitter) ? emitter.radiant_intensity() : 0.0;
    });
  };
  const MotionKeys keys = motion(number);
  const double mean = keys.moving() ? mean_over_shutter(keys, at) : at(0.0f);
  return mean > 0.0 && std::isfinite(mean) ? mean : 0.0;
}

LightBounds Emitters::bounds(std::size_t number) const {
  LightBounds bounds;
  bounds.intensity = radiant_intensity(number);
  const MotionKeys keys = motion(number);
  visit(number, 0.0f, [&](const auto& emitter) {
    if (!keys.moving()) face(bounds, emitter);
    spread(bounds, emitter);
  });
  // Linear motion stays in the box of its keys.
  for (std::uint32_t i = 0; i <= keys.segments; ++i) {
    const float time = keys.moving() ? static_cast<float>(i) / static_cast<float>(keys.segments) : 0.0f;
    visit(number, time, [&](const auto& emitter) { extend(bounds, emitter); });
  }
  return bounds;
}

AreaLight Emitters::area_at(std::size_t number, float time) const {
  const AreaLight& light = areas_[number];
  const TriangleKey corners =
      key_at<TriangleKey>(triangle_keys_, area_motion_[number], time,
                          [](const TriangleKey& a, const TriangleKey& b, float t) -> TriangleKey {
                            return {interpolate_linear(a[0], b[0], t), interpolate_linear(a[1], b[1], t),
                                    interpolate_linear(a[2], b[2], t)};
                          });
  return {area_corners_[number].shape(corners), light.radiance, light.two_sided, light.group, light.extent};
}

EmissiveSphere Emitters::sphere_at(const EmissiveSphere& sphere, float time) const {
  if (!sphere.motion.moving()) return sphere;
  const SphereKey key = key_at<SphereKey>(
      sphere_keys_, sphere.motion, time, [](const SphereKey& a, const SphereKey& b, float t) -> SphereKey {
        return {interpolate_linear(a.center, b.center, t), a.radius * (1.0f - t) + b.radius * t};
      });
  return {key.center, key.radius, sphere.radiance, sphere.two_sided, sphere.group, {}};
}

PointLight Emitters::point_at(const PointLight& point, float time) const {
  if (!point.motion.moving()) return point;
  return {key_at<V3f>(point_keys_, point.motion, time, interpolate_linear), point.intensity, point.group, {}};
}

SpotEmitter Emitters::spot_at(const SpotEmitter& spot, float time) const {
  if (!spot.motion.moving()) return spot;
  const SpotKey key = key_at<
      SpotKey>(spot_keys_, spot.motion, time, [](const SpotKey& a, const SpotKey& b, float t) -> SpotKey {
    return {interpolate_linear(a.position, b.position, t), interpolate_linear(a.direction, b.direction, t)};
  });
  SpotEmitter now = spot;
  now.position = key.position;
  now.axis = V3d(key.direction).normalized();
  return now;
}

double Emitters::irradiance_at(std::size_t number, const Receiver& at, float time) const {
  return visit(number, time, [&](const auto& emitter) { return emitter.irradiance_at(at); });
}

bool Emitters::reaches(std::size_t number, const Receiver& at, float time) const {
  return visit(number, time, [&](const auto& emitter) { return emitter.reaches(at); });
}

std::optional<LightSample> Emitters::sample(std::size_t number, const Receiver& at, float time,
                                            const V2f& u) const {
  return visit(number, time, [&](const auto& emitter) { return emitter.sample(at, u); });
}

float Emitters::pdf_area(std::size_t number, const Receiver& at, const V3f& dir_world, float distance,
                         float time) const {
  return moving_area(number) ? area_at(number, time).pdf_solid_angle(at, dir_world, distance)
                             : areas_[number].pdf_solid_angle(at, dir_world, distance);
}

float Emitters::pdf_sphere(std::size_t sphere, const Receiver& at, float time) const {
  return sphere_at(spheres_[sphere], time).pdf_solid_angle(at);
}

}  // namespace becalm::tracer
