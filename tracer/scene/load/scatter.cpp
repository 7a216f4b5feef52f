#include "tracer/scene/load/scatter.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <optional>

#include "frame/error.h"
#include "tracer/sampling/sobol.h"
#include "tracer/scene/load/load_values.h"
#include "tracer/snapshot/frame_shapes.h"
#include "tracer/snapshot/intersect.h"

namespace becalm::tracer {

namespace {

/// Numbers in [0,1) for one copy.
class CopyRandom {
 public:
  CopyRandom(std::uint32_t seed, std::uint32_t copy) : key_(mix_bits(std::uint64_t{seed} << 32 | copy)) {}
  double next() { return to_unit_double(mix_bits(key_ += 0x9e3779b97f4a7c15ull)); }

 private:
  std::uint64_t key_;
};

/// The height of a ground under points, by rays from above.
class Ground {
 public:
  Ground(const SceneDescription& scene, const Object& object)
      : shapes_({&scene.meshes[object.mesh], 1}, scene.frames.first),
        to_world_(transform_at(object.transform, 0.0)) {
    const Placement placement{shapes_[0], &opaque_, {&to_world_, 1}, false};
    intersector_.emplace(std::span(&placement, 1));
    intersector_->commit();
    const Imath::Box3f& box = shapes_.bounds(0);
    const double reach = std::max(box.max.length(), box.min.length());
    double scale = 0.0;
    for (int row = 0; row < 3; ++row)
      scale += V3f(to_world_[row][0], to_world_[row][1], to_world_[row][2]).length();
    top_ = to_world_[3][1] + 1.001 * reach * scale;
    if (std::abs(top_) <= kLargestCoordinate) return;
    throw Error(
        ExitStatus::bad_input,
        fmt::format("{}: /objects: the ground '{}' may reach to a height of {:g}, expected at most {:g}",
                    scene.file, object.name, top_, kLargestCoordinate));
  }

  std::optional<double> height(double x, double z) const {
    const Ray down{V3f(static_cast<float>(x), static_cast<float>(top_), static_cast<float>(z)),
                   V3f(0, -1, 0)};
    const std::optional<Hit> hit = intersector_->closest(down);
    if (!hit) return std::nullopt;
    return top_ - hit->t;
  }

 private:
  FrameShapes shapes_;
  const Material opaque_{};
  M44f to_world_;
  std::optional<Intersector> intersector_;
  double top_ = 0.0;
};

/// Point `index` of the additive sequence of Roberts, "The Unreasonable Effectiveness of Quasirandom
/// Sequences", 2018, which spreads any number of points evenly.
V2d spread(std::uint32_t index, const V2d& shift) {
  constexpr double plastic = 1.32471795724474602596;
  const double x = shift.x + index / plastic, y = shift.y + index / (plastic * plastic);
  return {x - std::floor(x), y - std::floor(y)};
}

}  // namespace

std::vector<Object> scattered_copies(const Object& object, const Scatter& scatter,
                                     const SceneDescription& scene, std::span<const Object> ground) {
  std::deque<Ground> heights;
  for (const Object& part : ground) heights.emplace_back(scene, part);
  CopyRandom shift_random(scatter.seed, ~0u);
  const double shift_x = shift_random.next();
  const V2d shift(shift_x, shift_random.next());
  std::vector<Object> copies;
  copies.reserve(scatter.count);
  for (std::uint32_t i = 0; i < scatter.count; ++i) {
    CopyRandom random(scatter.seed, i);
    const V2d point = spread(i, shift);
    const double x = scatter.x0 + point.x * (scatter.x1 - scatter.x0);
    const double z = scatter.z0 + point.y * (scatter.z1 - scatter.z0);
    const double yaw = random.next() * 360.0;
    const double lean = random.next() * scatter.tilt_deg;
    const double lean_to = random.next() * 360.0;
    const double scale = scatter.scale_low + random.next() * (scatter.scale_high - scatter.scale_low);
    double y = 0.0;
    if (!heights.empty()) {
      std::optional<double> topmost;
      for (const Ground& part : heights) topmost = std::max(topmost, part.height(x, z));
      if (!topmost) continue;
      y = *topmost;
    }
    // Upright, leaned towards a direction, turned about the upright axis.
    const M44d turn = transform_at(TransformCurve::Value{0, 0, 0, 0, yaw, 0, 1, 1, 1}, 0.0);
    const M44d towards = transform_at(TransformCurve::Value{0, 0, 0, 0, lean_to, 0, 1, 1, 1}, 0.0);
    const M44d away = transform_at(TransformCurve::Value{0, 0, 0, 0, -lean_to, 0, 1, 1, 1}, 0.0);
    const M44d leaned =
        away * transform_at(TransformCurve::Value{0, 0, 0, lean, 0, 0, 1, 1, 1}, 0.0) * towards * turn;
    TransformCurve::Value value = object.transform.at(0.0);
    const V3d own = transform_vector(V3d(value[0], value[1], value[2]), leaned) * scale;
    const M44d own_rotation =
        transform_at(TransformCurve::Value{0, 0, 0, value[3], value[4], value[5], 1, 1, 1}, 0.0);
    const V3d rotation_deg = rotation_angles_deg(own_rotation * leaned);
    for (int axis = 0; axis < 3; ++axis) {
      value[axis] = V3d(x, y, z)[axis] + own[axis];
      value[3 + axis] = rotation_deg[axis];
      value[6 + axis] *= scale;
    }
    Object& copy = copies.emplace_back(object);
    copy.name = fmt::format("{} {}", object.name, i + 1);
    copy.transform = value;
  }
  return copies;
}

}  // namespace becalm::tracer
