#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "tracer/scene/geometry.h"

namespace becalm::tracer {

struct Material;

struct Ray {
  V3f origin;
  V3f dir;  ///< any length; distances are in multiples of it
  float t_max = std::numeric_limits<float>::infinity();
  float time = 0.0f;       ///< in [0,1], from the shutter's opening to its closing
  std::uint32_t seed = 0;  ///< decides whether this ray meets surfaces that are partly there (opacity)
};

/// Between the seeds of a path's rays.
inline constexpr std::uint32_t kRaySeedStep = 0x9e3779b9u;

struct Hit {
  std::uint32_t object;
  std::uint32_t triangle;
  float u, v;  ///< barycentric weights of the triangle's second and third corner
  float t;
  V3f local;  ///< where there are no triangles: the point in object space
};

/// Where an object stands.
struct Placement {
  Shape shape;
  const Material* material;  ///< its opacity decides what rays pass through
  /// One, or more at equally spaced times from the shutter's opening to its closing, linear between them.
  std::span<const M44f> to_world;
  bool moving;  ///< from frame to frame
};

/// What the hierarchies hold.
struct GeometrySize {
  std::size_t baked_objects = 0;      ///< in the one hierarchy of world space
  std::size_t instances = 0;          ///< everything else: references to a hierarchy of their geometry
  std::size_t motion_instances = 0;   ///< those of them that move while the shutter is open
  std::size_t stored_triangles = 0;   ///< in memory
  std::size_t visible_triangles = 0;  ///< counted for each instance
  std::int64_t embree_bytes = 0;      ///< as Embree counts its memory: hierarchies and the buffers it owns
};

/// From now on Embree uses no instructions beyond SSE4.2, so that results do not depend on the processor: its
/// AVX2 code has fused multiply-add. No effect on processors that are not x86.
void limit_to_sse42();

/// Ray queries against all objects: the only code that sees Embree. Traversal is watertight along the edges
/// of a mesh.
///
/// Triangle meshes that stand still are baked into one hierarchy in world space. What moves, what has no
/// triangles, and meshes of which so many copies stand still that baking them would cost memory are instances
/// of a hierarchy in object space.
class Intersector {
 public:
  /// Builds the hierarchies of everything; call commit() before the first query. Geometries and materials
  /// must outlive this. Throws Error(resource) if memory does not suffice.
  explicit Intersector(std::span<const Placement> placements);
  ~Intersector();

  /// Gives a moving object a new place from the next commit() on.
  void move(std::uint32_t object, std::span<const M44f> to_world);
  /// What the shape refers to has changed; only for what is not made of triangles.
  void reshape(const Shape& shape);
  /// Rebuilds what moved; nothing if nothing did.
  void commit();

  std::optional<Hit> closest(const Ray& ray) const;
  bool occluded(const Ray& ray) const;

  GeometrySize size() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::tracer
