#include "tracer/snapshot/snapshot.h"

#include <Imath/ImathBoxAlgo.h>
#include <fmt/format.h>

#include <set>

#include "frame/error.h"
#include "tracer/snapshot/emissive_objects.h"
#include "tracer/snapshot/update_medium.h"

namespace becalm::tracer {

namespace {

/// Linear pieces of the motion of lights without a surface while the shutter is open.
constexpr std::uint32_t kLightSegments = 8;

/// Throws unless the camera has a direction at the shutter's opening and closing of this frame and the one
/// before.
void check_camera(const SceneDescription& description, int frame) {
  for (const int f : {frame, frame - 1}) {
    for (const double time : {0.0, 1.0}) {
      if (is_valid(look_at(description.camera.look_at, description.camera.shutter.at(f, time)))) continue;
      throw Error(
          ExitStatus::bad_input,
          fmt::format(
              "{}: /camera/look_at: at frame {} the eye meets the target, or up points along the view",
              description.file, f));
    }
  }
}

/// The inverse transpose up to a positive factor: the cofactors, turned around where space is mirrored. Needs
/// no division, so that flattened objects have normals too.
M44f normal_matrix(const M44d& m) {
  const V3d x(m[0][0], m[0][1], m[0][2]), y(m[1][0], m[1][1], m[1][2]), z(m[2][0], m[2][1], m[2][2]);
  const V3d rows[3] = {y.cross(z), z.cross(x), x.cross(y)};
  const double sign = x.dot(rows[0]) < 0.0 ? -1.0 : 1.0;
  double largest = 0.0;
  for (const V3d& row : rows)
    largest = std::max({largest, std::abs(row.x), std::abs(row.y), std::abs(row.z)});
  M44f result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      result[i][j] = largest > 0.0 ? static_cast<float>(sign * rows[i][j] / largest) : 0.0f;
  }
  return result;
}

MotionSteps<float> to_float(const MotionSteps<double>& steps) {
  return MotionSteps<float>(std::vector<M44f>(steps.steps().begin(), steps.steps().end()));
}

bool geometry_moves(const Object& object) {
  return object.transform.animated();
}

}  // namespace

Place ObjectState::at(float time) const {
  if (!blurred()) return place;
  const M44f to_world = blur.at(time);
  return {to_world, normal_matrix(M44d(to_world))};
}

Snapshot::Snapshot(const SceneDescription& description, int frame)
    : description_(&description),
      frame_(frame),
      shapes_(description.meshes, description.camera.shutter.at(frame, 0.5)),
      objects_(description.objects.size()) {
  check_camera(description, frame);
  std::vector<Placement> placements;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const Object& object = description.objects[i];
    ObjectState& state = objects_[i];
    state.shape = shapes_[object.mesh];
    state.mesh = mesh_of(state.shape);
    state.material = &description.materials[object.material];
    const MaterialNeeds needs = material_needs(description.materials, *state.material);
    state.material_varies = needs.textures || needs.relief || needs.mix || needs.tangents;
    state.two_sided = object.two_sided;
    state.light_group = object.light_group;
    place(i, frame);
  }
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const ObjectState& state = objects_[i];
    placements.push_back(
        {state.shape, state.material, state.blur.steps(), geometry_moves(description.objects[i])});
  }
  measure();
  intersector_ = std::make_unique<Intersector>(placements);
  intersector_->commit();
  build_lights(frame);
  interiors_.resize(
      std::ranges::count_if(description.objects, [](const Object& o) { return o.interior.has_value(); }));
  update_media(frame);
}

void Snapshot::set_frame(int frame) {
  if (frame == frame_ && whole_) return;
  check_camera(*description_, frame);
  // If the last call threw, everything that may have changed is made anew.
  const bool all = !std::exchange(whole_, false);
  bool moved = all, lights_changed = all;
  const Shutter& shutter = description_->camera.shutter;
  for (const std::size_t geometry : shapes_.set_frame(shutter.at(frame, 0.5))) {
    intersector_->reshape(shapes_[geometry]);
    moved = true;
  }
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const Object& object = description_->objects[i];
    if (geometry_moves(object)) {
      const std::vector<M44f> before = objects_[i].blur.steps();
      place(i, frame);
      if (all || objects_[i].blur.steps() != before) {
        intersector_->move(static_cast<std::uint32_t>(i), objects_[i].blur.steps());
        moved = true;
        lights_changed = lights_changed || object.emissive;
      }
    }
    lights_changed = lights_changed || object.emission.at(shutter.at(frame, 0.5)) !=
                                           object.emission.at(shutter.at(frame_, 0.5));
  }
  if (moved) {
    measure();
    intersector_->commit();
  }
  for (const LightDescription& light : description_->lights) {
    lights_changed = lights_changed || animated(light);
  }
  if (lights_changed) build_lights(frame);
  update_media(frame);
  frame_ = frame;
  whole_ = true;
}

void Snapshot::update_media(int frame) {
  auto medium = interiors_.begin();
  std::vector<const Medium*> made(description_->media.size());  // the first one of each description
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const std::optional<std::uint32_t>& interior = description_->objects[i].interior;
    if (!interior) continue;
    const Medium*& first = made[*interior];
    if (first != nullptr) *medium = *first;  // with its grid, which is not baked again
    update_medium(description_->media[*interior], description_->camera.shutter.at(frame, 0.5),
                  objects_[i].exact.at(0.5f), *medium);
    if (first == nullptr) first = &*medium;
    objects_[i].interior = &*medium++;
  }
}

std::size_t Snapshot::media_bytes() const {
  std::size_t sum = 0;
  std::set<const DensityGrid*> counted;
  for (const Medium& medium : interiors_) {
    const auto* grid = std::get_if<GridMedium>(&medium);
    if (grid == nullptr || counted.insert(grid->density.get()).second) sum += bytes(medium);
  }
  return sum;
}

void Snapshot::place(std::size_t index, int frame) {
  const Object& object = description_->objects[index];
  const Shutter& shutter = description_->camera.shutter;
  const Imath::Box3f& box = shapes_.bounds(object.mesh);
  const double radius = box.isEmpty() ? 1.0 : std::max(std::max(box.max.length(), box.min.length()), 1e-30f);
  const auto steps = [&](int at) {
    return motion_steps(object.transform, at, shutter,
                        motion_segments(object.transform, at, shutter, radius));
  };
  ObjectState& state = objects_[index];
  state.exact = steps(frame);
  state.exact_previous = geometry_moves(object) ? steps(frame - 1) : state.exact;
  state.blur = to_float(state.exact);
  state.place = {state.blur.first(), normal_matrix(state.exact.first())};
  const M44d& first = state.exact.first();
  const auto axis = [&](int row) { return V3d(first[row][0], first[row][1], first[row][2]); };
  state.length_scale = static_cast<float>(std::cbrt(std::abs(axis(0).cross(axis(1)).dot(axis(2)))));
  state.scale = state.translation = 0.0f;
  for (const M44f& m : state.blur.steps()) {
    for (int column = 0; column < 3; ++column) {
      float sum = 0.0f;
      for (int row = 0; row < 3; ++row) sum += std::abs(m[row][column]);
      state.scale = std::max(state.scale, sum);
      state.translation = std::max(state.translation, std::abs(m[3][column]));
    }
  }
}

void Snapshot::measure() {
  Imath::Box3f bounds;
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const Imath::Box3f& box = shapes_.bounds(description_->objects[i].mesh);
    if (box.isEmpty()) continue;
    for (const M44f& to_world : objects_[i].blur.steps())
      bounds.extendBy(Imath::affineTransform(box, to_world));
  }
  if (bounds.isEmpty()) return;
  const float extent = std::max(largest_coordinate(bounds.min), largest_coordinate(bounds.max));
  // Embree leaves out what is larger than 2^60, and squared distances must stay finite.
  if (!(extent < 1e17f)) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: /objects: coordinates reach {:g}, expected less than 1e17",
                            description_->file, extent));
  }
}

void Snapshot::build_lights(int frame) {
  LightList list;
  const Shutter& shutter = description_->camera.shutter;
  add_emissive_objects(*description_, shutter.at(frame, 0.5), objects_, list);
  add_lights(description_->lights,
             {shutter.at(frame, 0.0), shutter.at(frame, 1.0), shutter.blurs() ? kLightSegments : 0}, list);
  list.environment = description_->environment;
  list.environment_group = description_->environment_group;
  lights_ = Lights(std::move(list));
}

}  // namespace becalm::tracer
