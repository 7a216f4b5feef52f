#include "tracer/scene/geometry.h"

namespace becalm::tracer {

namespace {

Imath::Box3f bounds_of(const Mesh* mesh) {
  Imath::Box3f box;
  for (const V3f& position : mesh->positions) box.extendBy(position);
  return box;
}
Imath::Box3f bounds_of(const UnitSphere&) {
  return {V3f(-1.0f), V3f(1.0f)};
}
Imath::Box3f bounds_of(const Procedural* procedural) {
  return bounds(*procedural);
}

}  // namespace

Imath::Box3f bounds(const Shape& shape) {
  return std::visit([](const auto& s) { return bounds_of(s); }, shape);
}

std::size_t triangle_count(const Shape& shape) {
  const Mesh* mesh = mesh_of(shape);
  return mesh != nullptr ? mesh->triangles.size() : 0;
}

std::size_t triangle_count(const Geometry& geometry) {
  const Mesh* mesh = std::get_if<Mesh>(&geometry);
  return mesh != nullptr ? mesh->triangles.size() : 0;
}

}  // namespace becalm::tracer
