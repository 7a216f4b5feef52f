#include "tracer/intersect.h"

#include <embree3/rtcore.h>

#include <cassert>
#include <map>
#include <string>

#include "frame/error.h"

namespace becalm::tracer {

namespace {

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
  r.time = 0.0f;
  r.mask = ~0u;
  r.id = 0;
  r.flags = 0;
  return r;
}

}  // namespace

struct Intersector::State {
  State() : device(rtcNewDevice(nullptr)) {
    if (!device) throw Error(ExitStatus::resource, "Embree cannot start on this machine");
  }

  ScenePtr new_scene(RTCSceneFlags flags, RTCBuildQuality quality) const {
    ScenePtr scene(rtcNewScene(device.get()));
    rtcSetSceneFlags(scene.get(), flags);
    rtcSetSceneBuildQuality(scene.get(), quality);
    return scene;
  }

  /// Throws if Embree reported trouble since the last call.
  void check() const {
    const RTCError error = rtcGetDeviceError(device.get());
    if (error == RTC_ERROR_NONE) return;
    throw Error(ExitStatus::resource,
                error == RTC_ERROR_OUT_OF_MEMORY
                    ? std::string("the scene's geometry does not fit into memory")
                    : "Embree error " + std::to_string(error) + " while building geometry");
  }

  /// Attaches the mesh's triangles under that geometry number, moved by `to_world` unless it is null.
  void attach(RTCScene scene, unsigned number, const Mesh& mesh, const M44f* to_world) const {
    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.positions.size()));
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), mesh.triangles.size()));
    if (vertices != nullptr && indices != nullptr) {
      for (const V3f& position : mesh.positions) {
        const V3f p = to_world ? transform_point(position, *to_world) : position;
        vertices = std::copy(&p.x, &p.x + 3, vertices);
      }
      for (const auto& triangle : mesh.triangles)
        indices = std::copy(triangle.begin(), triangle.end(), indices);
      rtcCommitGeometry(geometry);
      rtcAttachGeometryByID(scene, geometry, number);
    }
    rtcReleaseGeometry(geometry);
    check();
  }

  /// Attaches a scene as an instance under that number.
  RTCGeometry attach_instance(unsigned number, RTCScene instanced, const M44f& to_world) const {
    RTCGeometry instance = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, instanced);
    // Imath's row vectors and row-major order lay a matrix out as column vectors in column-major order do.
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, to_world.getValue());
    rtcCommitGeometry(instance);
    rtcAttachGeometryByID(root, instance, number);
    rtcReleaseGeometry(instance);  // the scene keeps it
    check();
    return instance;
  }

  DevicePtr device;
  ScenePtr static_scene;
  std::map<const Mesh*, ScenePtr> mesh_scenes;
  ScenePtr instances_scene;
  RTCScene root = nullptr;  ///< what rays are traced against: static_scene alone if nothing moves

  std::vector<std::uint32_t> static_objects;  ///< object of each geometry of static_scene
  std::vector<std::uint32_t> moving_objects;  ///< object of each instance; the first instance is static_scene
  std::vector<RTCGeometry> instance_of_object;  ///< null for static ones
  bool dirty = true;
};

Intersector::Intersector(std::span<const Placement> placements) : state_(std::make_unique<State>()) {
  State& s = *state_;
  // High quality builds with spatial splits: a hierarchy is built once and traced for a whole shot.
  s.static_scene = s.new_scene(RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_HIGH);
  s.root = s.static_scene.get();
  s.instance_of_object.assign(placements.size(), nullptr);
  for (std::uint32_t object = 0; object < placements.size(); ++object) {
    const Placement& placement = placements[object];
    if (placement.moving) continue;
    s.attach(s.static_scene.get(), static_cast<unsigned>(s.static_objects.size()), *placement.mesh,
             &placement.to_world);
    s.static_objects.push_back(object);
  }
  rtcCommitScene(s.static_scene.get());
  s.check();
  if (s.static_objects.size() == placements.size()) return;

  s.instances_scene = s.new_scene(static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC),
                                  RTC_BUILD_QUALITY_LOW);
  s.root = s.instances_scene.get();
  s.moving_objects.push_back(kNotAnInstance);
  s.attach_instance(0, s.static_scene.get(), M44f());
  for (std::uint32_t object = 0; object < placements.size(); ++object) {
    const Placement& placement = placements[object];
    if (!placement.moving) continue;
    ScenePtr& mesh_scene = s.mesh_scenes[placement.mesh];
    if (!mesh_scene) {
      mesh_scene = s.new_scene(RTC_SCENE_FLAG_ROBUST, RTC_BUILD_QUALITY_HIGH);
      s.attach(mesh_scene.get(), 0, *placement.mesh, nullptr);
      rtcCommitScene(mesh_scene.get());
      s.check();
    }
    s.instance_of_object[object] = s.attach_instance(static_cast<unsigned>(s.moving_objects.size()),
                                                     mesh_scene.get(), placement.to_world);
    s.moving_objects.push_back(object);
  }
}

Intersector::~Intersector() = default;

void Intersector::move(std::uint32_t object, const M44f& to_world) {
  RTCGeometry instance = state_->instance_of_object[object];
  assert(instance != nullptr);
  rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, to_world.getValue());
  rtcCommitGeometry(instance);
  state_->dirty = true;
}

void Intersector::commit() {
  if (!state_->dirty) return;
  if (state_->instances_scene) rtcCommitScene(state_->instances_scene.get());
  state_->check();
  state_->dirty = false;
}

std::optional<Hit> Intersector::closest(const Ray& ray) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query;
  query.ray = to_embree(ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(state_->root, &context, &query);
  const RTCHit& hit = query.hit;
  if (hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  const bool is_static = hit.instID[0] == RTC_INVALID_GEOMETRY_ID || hit.instID[0] == 0;
  const std::uint32_t object =
      is_static ? state_->static_objects[hit.geomID] : state_->moving_objects[hit.instID[0]];
  return Hit{object, hit.primID, hit.u, hit.v, query.ray.tfar};
}

bool Intersector::occluded(const Ray& ray) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay query = to_embree(ray);
  rtcOccluded1(state_->root, &context, &query);
  return query.tfar < 0.0f;  // Embree's mark of a hit: -inf
}

}  // namespace becalm::tracer
