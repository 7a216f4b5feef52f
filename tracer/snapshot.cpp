#include "tracer/snapshot.h"

#include <Imath/ImathBoxAlgo.h>
#include <fmt/format.h>

#include "frame/error.h"

namespace becalm::tracer {

namespace {

LookAt checked_look_at(const SceneDescription& description, int frame) {
  LookAt view = look_at(description.camera.look_at, frame);
  if (!is_valid(view)) {
    throw Error(
        ExitStatus::bad_input,
        fmt::format("{}: /camera/look_at: at frame {} the eye meets the target, or up points along the view",
                    description.file, frame));
  }
  return view;
}

}  // namespace

Snapshot::Snapshot(const SceneDescription& description, int frame)
    : description_(&description), frame_(frame), objects_(description.objects.size()) {
  camera_ = checked_look_at(description, frame);
  previous_camera_ = checked_look_at(description, frame - 1);
  for (const Mesh& mesh : description.meshes) {
    Imath::Box3f& box = mesh_bounds_.emplace_back();
    for (const V3f& position : mesh.positions) box.extendBy(position);
  }
  std::vector<Placement> placements;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const Object& object = description.objects[i];
    objects_[i].mesh = &description.meshes[object.mesh];
    objects_[i].material = &description.materials[object.material];
    objects_[i].two_sided = object.two_sided;
    place(i, frame);
    placements.push_back({objects_[i].mesh, objects_[i].to_world, object.transform.animated()});
  }
  measure();
  intersector_ = std::make_unique<Intersector>(placements);
  intersector_->commit();
  build_lights(frame);
}

void Snapshot::set_frame(int frame) {
  if (frame == frame_) return;
  camera_ = checked_look_at(*description_, frame);
  previous_camera_ = checked_look_at(*description_, frame - 1);
  bool moved = false, lights_changed = false;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const Object& object = description_->objects[i];
    if (object.transform.animated()) {
      const M44f before = objects_[i].to_world;
      place(i, frame);
      if (objects_[i].to_world != before) {
        intersector_->move(static_cast<std::uint32_t>(i), objects_[i].to_world);
        moved = true;
        lights_changed = lights_changed || object.emissive;
      }
    }
    lights_changed = lights_changed || object.emission.at(frame) != object.emission.at(frame_);
  }
  if (moved) {
    measure();
    intersector_->commit();
  }
  for (const LightDescription& light : description_->lights) {
    lights_changed = lights_changed || animated(light);
  }
  // The share of light from infinity depends on the scene's size, so any motion counts beside it.
  if (lights_changed || (moved && (description_->environment || !description_->lights.empty())))
    build_lights(frame);
  frame_ = frame;
}

void Snapshot::place(std::size_t index, int frame) {
  const TransformCurve& transform = description_->objects[index].transform;
  ObjectState& state = objects_[index];
  state.to_world_exact = transform_at(transform, frame);
  state.to_world_previous = transform.animated() ? transform_at(transform, frame - 1) : state.to_world_exact;
  state.to_world = M44f(state.to_world_exact);
  state.normal_to_world = M44f(state.to_world_exact.inverse().transposed());
  state.scale = state.translation = 0.0f;
  for (int column = 0; column < 3; ++column) {
    float sum = 0.0f;
    for (int row = 0; row < 3; ++row) sum += std::abs(state.to_world[row][column]);
    state.scale = std::max(state.scale, sum);
    state.translation = std::max(state.translation, std::abs(state.to_world[3][column]));
  }
}

void Snapshot::measure() {
  Imath::Box3f bounds;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const Imath::Box3f& box = mesh_bounds_[description_->objects[i].mesh];
    if (!box.isEmpty()) bounds.extendBy(Imath::affineTransform(box, objects_[i].to_world));
  }
  extent_ = radius_ = 0.0f;
  if (bounds.isEmpty()) return;
  for (int axis = 0; axis < 3; ++axis) {
    extent_ = std::max({extent_, std::abs(bounds.min[axis]), std::abs(bounds.max[axis])});
  }
  radius_ = 0.5f * bounds.size().length();
  // Embree leaves out what is larger than 2^60, and squared distances must stay finite.
  if (!(extent_ < 1e17f)) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: /objects: coordinates reach {:g}, expected less than 1e17",
                            description_->file, extent_));
  }
}

void Snapshot::build_lights(int frame) {
  LightList list;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    ObjectState& object = objects_[i];
    const Curve<3>::Value emission = description_->objects[i].emission.at(frame);
    object.emission = {static_cast<float>(emission[0]), static_cast<float>(emission[1]),
                       static_cast<float>(emission[2])};
    object.first_light = kNoLight;
    if (is_black(object.emission)) continue;
    object.first_light = static_cast<std::uint32_t>(list.triangles.size());
    // Mirroring turns the winding around, but not what is outside.
    const bool mirrored = object.to_world_exact.determinant() < 0.0;
    for (const auto& corners : object.mesh->triangles) {
      V3f p[3];
      for (int k = 0; k < 3; ++k) p[k] = transform_point(object.mesh->positions[corners[k]], object.to_world);
      if (mirrored) std::swap(p[1], p[2]);
      list.triangles.push_back({p[0], p[1], p[2], object.emission, object.two_sided});
    }
  }
  add_lights(description_->lights, {static_cast<double>(frame), static_cast<double>(frame), 0}, list);
  list.environment = description_->environment;
  list.environment_group = description_->environment_group;
  list.scene_radius = radius_;
  lights_ = Lights(std::move(list));
}

}  // namespace becalm::tracer
