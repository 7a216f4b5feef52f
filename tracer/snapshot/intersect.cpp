#include "tracer/snapshot/intersect.h"

#include <embree3/rtcore.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cassert>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "frame/error.h"
#include "tracer/math/thickened.h"
#include "tracer/math/unit_sphere.h"
#include "tracer/snapshot/alpha_test.h"

namespace becalm::tracer {

namespace {

/// Of the devices that are made from now on; null: Embree decides.
std::atomic<const char*> embree_config{nullptr};

/// Embree's handles are counted; these give them C++ lifetimes.
struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using DevicePtr = std::unique_ptr<RTCDeviceTy, DeviceRelease>;
using ScenePtr = std::unique_ptr<RTCSceneTy, SceneRelease>;

constexpr std::uint32_t kNotAnInstance = ~0u;

/// Beside instances, the number of what is baked; theirs begin after it.
constexpr unsigned kBaked = 0;

/// Static copies of a mesh are instances when baking them all would store this many triangles more: an
/// instance costs each ray that enters it about as much as a few levels of the hierarchy.
constexpr std::size_t kInstancedTriangles = 100'000;

/// Geometry in object space, and what its filter functions need to know.
struct Source {
  Shape shape;
  const Material* material;
  friend auto operator<=>(const Source&, const Source&) = default;
};

RTCRay to_embree(const Ray& ray) {
  RTCRay r;
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.dir_x = ray.dir.x;
  r.dir_y = ray.dir.y;
  r.dir_z = ray.dir.z;
  r.tnear = 0.0f;
  r.tfar = ray.t_max;
  r.time = ray.time;
  r.mask = ~0u;
  r.id = ray.seed;
  r.flags = 0;
  return r;
}

/// Whether the ray may meet the box; rounding errors count as yes.
bool may_meet(const RTCBounds& box, const RTCRay& ray) {
  const float origin[] = {ray.org_x, ray.org_y, ray.org_z}, dir[] = {ray.dir_x, ray.dir_y, ray.dir_z};
  const float lower[] = {box.lower_x, box.lower_y, box.lower_z};
  const float upper[] = {box.upper_x, box.upper_y, box.upper_z};
  float first = ray.tnear, last = ray.tfar;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr float least = 1e-18f;  // products with the inverse stay finite
    const float inverse = 1.0f / std::copysign(std::max(std::abs(dir[axis]), least), dir[axis]);
    const float to_lower = (lower[axis] - origin[axis]) * inverse;
    const float to_upper = (upper[axis] - origin[axis]) * inverse;
    first = std::max(first, std::min(to_lower, to_upper));
    last = std::min(last, std::max(to_lower, to_upper));
  }
  constexpr float rounding = 1e-6f;
  return first * (1.0f - rounding) <= last * (1.0f + rounding);
}

/// The first place with a distance in (0, tfar) at which the ray meets a shape without triangles, in object
/// space.
std::optional<LocalHit> first_hit(const Shape& shape, const RTCRay& ray) {
  const V3f origin(ray.org_x, ray.org_y, ray.org_z), dir(ray.dir_x, ray.dir_y, ray.dir_z);
  const Procedural* procedural = procedural_of(shape);
  if (procedural == nullptr) return intersect_unit_sphere(origin, dir, ray.tfar);
  const std::optional<float> t = intersect(*procedural, origin, dir, ray.tnear, ray.tfar);
  if (!t) return std::nullopt;
  return LocalHit{*t, origin + *t * dir};
}

void user_bounds(const RTCBoundsFunctionArguments* args) {
  const Imath::Box3f box = bounds(static_cast<const Source*>(args->geometryUserPtr)->shape);
  RTCBounds& b = *args->bounds_o;
  b.lower_x = box.min.x;
  b.lower_y = box.min.y;
  b.lower_z = box.min.z;
  b.upper_x = box.max.x;
  b.upper_y = box.max.y;
  b.upper_z = box.max.z;
}

void user_intersect(const RTCIntersectFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  assert(args->N == 1);
  auto& query = *reinterpret_cast<RTCRayHit*>(args->rayhit);
  const Shape& shape = static_cast<const Source*>(args->geometryUserPtr)->shape;
  const std::optional<LocalHit> hit = first_hit(shape, query.ray);
  if (!hit) return;
  query.ray.tfar = hit->distance;
  query.hit.u = query.hit.v = 0.0f;
  // The place of the normal, which Embree passes on as it is, carries the point in object space.
  query.hit.Ng_x = hit->point.x;
  query.hit.Ng_y = hit->point.y;
  query.hit.Ng_z = hit->point.z;
  query.hit.primID = 0;
  query.hit.geomID = args->geomID;
  query.hit.instID[0] = args->context->instID[0];
}

void user_occluded(const RTCOccludedFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  assert(args->N == 1);
  auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
  const Shape& shape = static_cast<const Source*>(args->geometryUserPtr)->shape;
  if (first_hit(shape, ray)) ray.tfar = -std::numeric_limits<float>::infinity();
}

/// Lets rays pass where the surface is not there.
void filter_opacity(const RTCFilterFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  assert(args->N == 1);
  const auto& source = *static_cast<const Source*>(args->geometryUserPtr);
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  const auto& ray = *reinterpret_cast<const RTCRay*>(args->ray);
  const std::uint32_t surface = hit.geomID ^ (hit.instID[0] * 0x9e3779b9u);
  if (!alpha_test(*source.material, *mesh_of(source.shape), hit.primID, hit.u, hit.v,
                  alpha_random(ray.id, surface, hit.primID))) {
    args->valid[0] = 0;
  }
}

}  // namespace

void limit_to_sse42() {
#if defined(__x86_64__)
  embree_config = "isa=sse4.2";
#endif
}

struct Intersector::State {
  State() : device(rtcNewDevice(embree_config.load())) {
    if (!device) throw Error(ExitStatus::resource, "Embree cannot start on this machine");
    // Embree keeps errors for each thread; check() reports the first of any thread.
    rtcSetDeviceErrorFunction(
        device.get(),
        [](void* first, RTCError error, const char*) {
          RTCError none = RTC_ERROR_NONE;
          static_cast<std::atomic<RTCError>*>(first)->compare_exchange_strong(none, error);
        },
        &first_error);
    rtcSetDeviceMemoryMonitorFunction(
        device.get(),
        [](void* counter, ssize_t bytes, bool) {
          static_cast<std::atomic<std::int64_t>*>(counter)->fetch_add(bytes, std::memory_order_relaxed);
          return true;
        },
        &embree_bytes);
  }

  ScenePtr new_scene(RTCSceneFlags flags, RTCBuildQuality quality) const {
    ScenePtr scene(rtcNewScene(device.get()));
    rtcSetSceneFlags(scene.get(), flags);
    rtcSetSceneBuildQuality(scene.get(), quality);
    return scene;
  }

  /// Traces the baked hierarchy, then, over what is left of the ray, that of the instances: baked geometry as
  /// one more instance would take 10 % longer. trace(scene, context) returns whether nothing more is needed.
  template <class Trace>
  void trace_each(const RTCRay& ray, const Trace& trace) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (baked_scene) {
      if (instances_scene) context.instID[0] = kBaked;
      if (trace(baked_scene.get(), context)) return;
      context.instID[0] = RTC_INVALID_GEOMETRY_ID;
    }
    if (instances_scene && may_meet(instances_bounds, ray)) trace(instances_scene.get(), context);
  }

  /// Throws if Embree reported trouble since the last call.
  void check() {
    const RTCError error = first_error.exchange(RTC_ERROR_NONE);
    if (error == RTC_ERROR_NONE) return;
    throw Error(ExitStatus::resource,
                error == RTC_ERROR_OUT_OF_MEMORY
                    ? std::string("the scene's geometry does not fit into memory")
                    : "Embree error " + std::to_string(error) + " while building geometry");
  }

  /// A mesh's triangles, moved by `to_world` unless it is null.
  RTCGeometry new_triangles(const Mesh& mesh, const M44f* to_world) const {
    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.positions.size()));
    // The indices need no transform, so Embree shares them.
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                               3 * sizeof(std::uint32_t), mesh.triangles.size());
    if (vertices != nullptr) {
      for (const V3f& position : mesh.positions) {
        const V3f p = to_world ? transform_point(position, *to_world) : position;
        vertices = std::copy(&p.x, &p.x + 3, vertices);
      }
    }
    return geometry;
  }

  RTCGeometry new_user_geometry() const {
    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, 1);
    rtcSetGeometryBoundsFunction(geometry, user_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, user_intersect);
    rtcSetGeometryOccludedFunction(geometry, user_occluded);
    return geometry;
  }

  /// Attaches the geometry under that number. The source must keep its address.
  void attach(RTCScene scene, unsigned number, const Source& source, const M44f* to_world) const {
    const Mesh* mesh = mesh_of(source.shape);
    RTCGeometry geometry = mesh != nullptr ? new_triangles(*mesh, to_world) : new_user_geometry();
    rtcSetGeometryUserData(geometry, const_cast<Source*>(&source));
    if (mesh != nullptr && has_alpha(*source.material)) {
      rtcSetGeometryIntersectFilterFunction(geometry, filter_opacity);
      rtcSetGeometryOccludedFilterFunction(geometry, filter_opacity);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, number);
    rtcReleaseGeometry(geometry);
  }

  static void set_transforms(RTCGeometry instance, std::span<const M44f> to_world) {
    rtcSetGeometryTimeStepCount(instance, static_cast<unsigned>(to_world.size()));
    // Imath's matrices (row vectors, row-major) have the memory layout of column vectors in column-major
    // order.
    for (unsigned step = 0; step < to_world.size(); ++step) {
      // Embree maps rays by its inverse, and ends the program where coordinates exceed 1.8e18 there.
      const M44f transform = thickened(to_world[step]);
      rtcSetGeometryTransform(instance, step, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, transform.getValue());
    }
    rtcCommitGeometry(instance);
  }

  /// Attaches a scene as an instance under that number.
  RTCGeometry attach_instance(unsigned number, RTCScene instanced, std::span<const M44f> to_world) const {
    RTCGeometry instance = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, instanced);
    set_transforms(instance, to_world);
    rtcAttachGeometryByID(instances_scene.get(), instance, number);
    rtcReleaseGeometry(instance);  // the scene keeps it
    return instance;
  }

  void bake(std::span<const Placement> placements, const std::vector<bool>& instanced);
  void build_instanced_geometry(std::span<const Placement> placements, const std::vector<bool>& instanced);
  void attach_instances(std::span<const Placement> placements, const std::vector<bool>& instanced);

  /// Notes whether the instance moves while the shutter is open.
  void count_motion(std::uint32_t object, bool moves) {
    if (moves && !motion_of_object[object]) ++size.motion_instances;
    if (!moves && motion_of_object[object]) --size.motion_instances;
    motion_of_object[object] = moves;
  }

  std::atomic<RTCError> first_error{RTC_ERROR_NONE};
  // Declared before the device, which updates it until it is destroyed.
  std::atomic<std::int64_t> embree_bytes{0};
  DevicePtr device;
  std::vector<Source> baked_sources;  ///< of each geometry of baked_scene
  ScenePtr baked_scene;               ///< null if there are instances alone
  std::map<Source, ScenePtr> instanced_scenes;
  ScenePtr instances_scene;  ///< null if there are none
  RTCBounds instances_bounds{};

  std::vector<std::uint32_t> baked_objects;      ///< object of each geometry of baked_scene
  std::vector<std::uint32_t> instanced_objects;  ///< object of each instance; kNotAnInstance for kBaked
  std::vector<RTCGeometry> instance_of_object;   ///< null for baked ones
  std::vector<bool> motion_of_object;
  GeometrySize size;
  bool dirty = true;
};

namespace {

std::vector<bool> choose_instanced(std::span<const Placement> placements) {
  std::map<Source, std::size_t> copies;
  for (const Placement& p : placements) ++copies[{p.shape, p.material}];
  std::vector<bool> instanced;
  instanced.reserve(placements.size());
  for (const Placement& p : placements) {
    const std::size_t spared = (copies[{p.shape, p.material}] - 1) * triangle_count(p.shape);
    instanced.push_back(p.moving || p.to_world.size() > 1 || mesh_of(p.shape) == nullptr ||
                        spared > kInstancedTriangles);
  }
  return instanced;
}

}  // namespace

void Intersector::State::bake(std::span<const Placement> placements, const std::vector<bool>& instanced) {
  // High quality builds with spatial splits: a hierarchy is built once and traced for a whole shot.
  baked_scene = new_scene(RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_HIGH);
  for (std::uint32_t object = 0; object < placements.size(); ++object) {
    if (!instanced[object]) baked_objects.push_back(object);
  }
  for (const std::uint32_t object : baked_objects)
    baked_sources.push_back({placements[object].shape, placements[object].material});
  tbb::parallel_for(std::size_t{0}, baked_objects.size(), [&](std::size_t i) {
    attach(baked_scene.get(), static_cast<unsigned>(i), baked_sources[i],
           &placements[baked_objects[i]].to_world.front());
  });
  for (const Source& source : baked_sources) size.stored_triangles += triangle_count(source.shape);
  size.baked_objects = baked_objects.size();
  size.visible_triangles = size.stored_triangles;
  check();
  rtcCommitScene(baked_scene.get());
  check();
}

void Intersector::State::build_instanced_geometry(std::span<const Placement> placements,
                                                  const std::vector<bool>& instanced) {
  for (std::size_t object = 0; object < placements.size(); ++object) {
    if (instanced[object])
      instanced_scenes.try_emplace({placements[object].shape, placements[object].material});
  }
  for (auto& [source, scene] : instanced_scenes) {
    scene = new_scene(RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_HIGH);
    attach(scene.get(), 0, source, nullptr);
    check();
    rtcCommitScene(scene.get());
    check();
    size.stored_triangles += triangle_count(source.shape);
  }
}

void Intersector::State::attach_instances(std::span<const Placement> placements,
                                          const std::vector<bool>& instanced) {
  instances_scene = new_scene(static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC),
                              RTC_BUILD_QUALITY_MEDIUM);
  instanced_objects.push_back(kNotAnInstance);
  if (baked_objects.empty()) baked_scene.reset();
  for (std::uint32_t object = 0; object < placements.size(); ++object) {
    if (!instanced[object]) continue;
    const Placement& p = placements[object];
    instance_of_object[object] =
        attach_instance(static_cast<unsigned>(instanced_objects.size()),
                        instanced_scenes.at({p.shape, p.material}).get(), p.to_world);
    instanced_objects.push_back(object);
    size.visible_triangles += triangle_count(p.shape);
    ++size.instances;
    count_motion(object, p.to_world.size() > 1);
  }
  check();
}

Intersector::Intersector(std::span<const Placement> placements) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.instance_of_object.assign(placements.size(), nullptr);
  s.motion_of_object.assign(placements.size(), false);
  const std::vector<bool> instanced = choose_instanced(placements);
  s.bake(placements, instanced);
  if (s.baked_objects.size() == placements.size()) return;
  s.build_instanced_geometry(placements, instanced);
  s.attach_instances(placements, instanced);
}

Intersector::~Intersector() = default;

void Intersector::move(std::uint32_t object, std::span<const M44f> to_world) {
  RTCGeometry instance = state_->instance_of_object[object];
  assert(instance != nullptr);
  State::set_transforms(instance, to_world);
  state_->count_motion(object, to_world.size() > 1);
  state_->dirty = true;
}

void Intersector::reshape(const Shape& shape) {
  for (auto& [source, scene] : state_->instanced_scenes) {
    if (source.shape != shape) continue;
    rtcCommitGeometry(rtcGetGeometry(scene.get(), 0));
    rtcCommitScene(scene.get());
    state_->dirty = true;
  }
  for (std::size_t i = 1; i < state_->instanced_objects.size(); ++i) {
    // Instances take the new bounds when they are committed.
    rtcCommitGeometry(rtcGetGeometry(state_->instances_scene.get(), static_cast<unsigned>(i)));
  }
}

void Intersector::commit() {
  if (!state_->dirty) return;
  if (state_->instances_scene) {
    rtcCommitScene(state_->instances_scene.get());
    rtcGetSceneBounds(state_->instances_scene.get(), &state_->instances_bounds);
  }
  state_->check();
  state_->dirty = false;
}

std::optional<Hit> Intersector::closest(const Ray& ray) const {
  RTCRayHit query;
  query.ray = to_embree(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  state_->trace_each(query.ray, [&](RTCScene scene, RTCIntersectContext& context) {
    rtcIntersect1(scene, &context, &query);
    return false;
  });
  const RTCHit& hit = query.hit;
  if (hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const bool is_baked = hit.instID[0] == RTC_INVALID_GEOMETRY_ID || hit.instID[0] == kBaked;
  const std::uint32_t object =
      is_baked ? state_->baked_objects[hit.geomID] : state_->instanced_objects[hit.instID[0]];
  return Hit{object, hit.primID, hit.u, hit.v, query.ray.tfar, V3f(hit.Ng_x, hit.Ng_y, hit.Ng_z)};
}

bool Intersector::occluded(const Ray& ray) const {
  RTCRay query = to_embree(ray);
  state_->trace_each(query, [&](RTCScene scene, RTCIntersectContext& context) {
    rtcOccluded1(scene, &context, &query);
    return query.tfar < 0.0f;  // Embree's mark of a hit: -inf
  });
  return query.tfar < 0.0f;
}

GeometrySize Intersector::size() const {
  GeometrySize size = state_->size;
  size.embree_bytes = state_->embree_bytes;
  return size;
}

}  // namespace becalm::tracer
