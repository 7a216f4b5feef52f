#include "tracer/snapshot/emissive_objects.h"

#include <algorithm>
#include <utility>

namespace becalm::tracer {

namespace {

MotionKeys motion_keys(const ObjectState& object, std::size_t key_count) {
  if (!object.blurred()) return {};
  return {static_cast<std::uint32_t>(key_count), static_cast<std::uint32_t>(object.blur.steps().size() - 1)};
}

TriangleKey triangle_at(const ObjectState& object, const std::array<std::uint32_t, 3>& corners,
                        const M44f& to_world) {
  TriangleKey key;
  for (int k = 0; k < 3; ++k) key[k] = transform_point(object.mesh->positions[corners[k]], to_world);
  // Mirroring reverses the winding; swapping two corners keeps the outside outside.
  if (M44d(to_world).determinant() < 0.0) std::swap(key[1], key[2]);
  return key;
}

/// What positions on the triangle are rounded relative to, in object and in world space.
float extent_of(const ObjectState& object, const std::array<std::uint32_t, 3>& corners) {
  float largest = 0.0f;
  for (const std::uint32_t corner : corners)
    largest = std::max(largest, largest_coordinate(object.mesh->positions[corner]));
  return largest * object.scale + object.translation;
}

void add_triangles(const ObjectState& object, LightList& lights) {
  for (const auto& corners : object.mesh->triangles) {
    const TriangleKey p = triangle_at(object, corners, object.place.to_world);
    lights.triangles.push_back({p[0], p[1], p[2], object.emission, object.two_sided, object.light_group,
                                motion_keys(object, lights.triangle_keys.size()),
                                extent_of(object, corners)});
    if (!object.blurred()) continue;
    for (const M44f& to_world : object.blur.steps())
      lights.triangle_keys.push_back(triangle_at(object, corners, to_world));
  }
}

/// The unit sphere's image: emissive spheres are scaled alike in all directions.
SphereKey sphere_at(const M44f& to_world) {
  return {V3f(to_world[3][0], to_world[3][1], to_world[3][2]),
          V3f(to_world[0][0], to_world[0][1], to_world[0][2]).length()};
}

void add_sphere(const ObjectState& object, LightList& lights) {
  const SphereKey sphere = sphere_at(object.place.to_world);
  lights.spheres.push_back({sphere.center, sphere.radius, object.emission, object.two_sided,
                            object.light_group, motion_keys(object, lights.sphere_keys.size())});
  if (!object.blurred()) return;
  for (const M44f& to_world : object.blur.steps()) lights.sphere_keys.push_back(sphere_at(to_world));
}

}  // namespace

void add_emissive_objects(const SceneDescription& description, double time, std::span<ObjectState> objects,
                          LightList& lights) {
  for (std::size_t i = 0; i < objects.size(); ++i) {
    ObjectState& object = objects[i];
    const Curve<3>::Value emission = description.objects[i].emission.at(time);
    object.emission = {static_cast<float>(emission[0]), static_cast<float>(emission[1]),
                       static_cast<float>(emission[2])};
    object.first_light = kNoLight;
    // Light sampling takes every point of a light to be there, so emitters with opacity are left to rays that
    // hit them by chance.
    if (is_black(object.emission) || has_alpha(*object.material)) continue;
    if (object.mesh != nullptr) {
      object.first_light = static_cast<std::uint32_t>(lights.triangles.size());
      add_triangles(object, lights);
    } else {
      object.first_light = static_cast<std::uint32_t>(lights.spheres.size());
      add_sphere(object, lights);
    }
  }
}

}  // namespace becalm::tracer
