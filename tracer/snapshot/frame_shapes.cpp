#include "tracer/snapshot/frame_shapes.h"

#include <algorithm>

namespace becalm::tracer {

FrameShapes::FrameShapes(std::span<const Geometry> geometries, double frame) : geometries_(geometries) {
  procedurals_.resize(std::ranges::count_if(
      geometries, [](const Geometry& g) { return std::holds_alternative<ProceduralDescription>(g); }));
  auto procedural = procedurals_.begin();
  for (const Geometry& geometry : geometries) {
    if (const Mesh* mesh = std::get_if<Mesh>(&geometry)) {
      shapes_.emplace_back(mesh);
    } else if (const auto* description = std::get_if<ProceduralDescription>(&geometry)) {
      update(*description, frame, *procedural);
      shapes_.emplace_back(&*procedural++);
    } else {
      shapes_.emplace_back(UnitSphere{});
    }
    bounds_.push_back(tracer::bounds(shapes_.back()));
  }
}

std::vector<std::size_t> FrameShapes::set_frame(double frame) {
  std::vector<std::size_t> changed;
  auto procedural = procedurals_.begin();
  for (std::size_t i = 0; i < geometries_.size(); ++i) {
    const auto* description = std::get_if<ProceduralDescription>(&geometries_[i]);
    if (description == nullptr || !update(*description, frame, *procedural++)) continue;
    bounds_[i] = tracer::bounds(shapes_[i]);
    changed.push_back(i);
  }
  return changed;
}

std::size_t FrameShapes::procedural_bytes() const {
  std::size_t sum = 0;
  for (const Procedural& procedural : procedurals_) sum += bytes(procedural);
  return sum;
}

}  // namespace becalm::tracer
