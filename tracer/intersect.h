#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "tracer/scene/mesh.h"

namespace becalm::tracer {

struct Ray {
  V3f origin;
  V3f dir;  ///< any length; distances are in multiples of it
  float t_max = std::numeric_limits<float>::infinity();
};

struct Hit {
  std::uint32_t object;
  std::uint32_t triangle;
  float u, v;  ///< barycentric weights of the triangle's second and third corner
  float t;
};

/// Where an object stands. Static ones share one bounding volume hierarchy in world space, moving ones are
/// instances of their mesh's.
struct Placement {
  const Mesh* mesh;
  M44f to_world;
  bool moving;
};

/// Ray queries against all objects: the only code that sees Embree. Traversal is watertight along the edges
/// of a mesh.
class Intersector {
 public:
  /// Builds the hierarchies of everything; call commit() before the first query. Throws Error(resource) if
  /// memory does not suffice.
  explicit Intersector(std::span<const Placement> placements);
  ~Intersector();

  /// Gives a moving object a new place from the next commit() on.
  void move(std::uint32_t object, const M44f& to_world);
  /// Rebuilds what moved; nothing if nothing did.
  void commit();

  std::optional<Hit> closest(const Ray& ray) const;
  bool occluded(const Ray& ray) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace becalm::tracer
