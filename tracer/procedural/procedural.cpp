#include "tracer/procedural/procedural.h"

#include <type_traits>

namespace becalm::tracer {

namespace {

template <class Description>
struct FieldOf;
template <>
struct FieldOf<TerrainDescription> {
  using Type = Terrain;
};
template <>
struct FieldOf<OceanDescription> {
  using Type = Ocean;
};
template <>
struct FieldOf<BlobsDescription> {
  using Type = Blobs;
};

}  // namespace

bool update(const ProceduralDescription& description, double frame, Procedural& procedural) {
  return std::visit(
      [&]<class Description>(const Description& d) {
        using Field = typename FieldOf<Description>::Type;
        if (!std::holds_alternative<Field>(procedural)) procedural.emplace<Field>();
        return std::get<Field>(procedural).update(d, frame);
      },
      description);
}

Imath::Box3f bounds(const Procedural& procedural) {
  return std::visit([](const auto& field) { return field.bounds(); }, procedural);
}

std::optional<float> intersect(const Procedural& procedural, const V3f& origin, const V3f& dir, float t_min,
                               float t_max) {
  return std::visit([&](const auto& field) { return field.intersect(origin, dir, t_min, t_max); },
                    procedural);
}

ProceduralPoint point(const Procedural& procedural, const V3f& p, float footprint) {
  return std::visit([&](const auto& field) { return field.point(p, footprint); }, procedural);
}

V3f point_before(const Procedural& procedural, const V3f& p) {
  return std::visit([&](const auto& field) { return field.point_before(p); }, procedural);
}

std::size_t bytes(const Procedural& procedural) {
  return std::visit([](const auto& field) { return field.bytes(); }, procedural);
}

}  // namespace becalm::tracer
