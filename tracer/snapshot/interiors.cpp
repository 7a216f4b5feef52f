#include "tracer/snapshot/interiors.h"

#include <vector>

namespace becalm::tracer {

namespace {

/// More surfaces in one direction than any scene has; ends the search where rounding finds the same one
/// again.
constexpr int kMostSurfaces = 10'000;

}  // namespace

Interiors interiors_at(const Snapshot& snapshot, const V3f& point) {
  std::vector<std::uint32_t> around, entered;  // from the inside out; those met on the way
  // Not along an axis, where the ray could lie in the face of a box.
  Ray ray{point, V3f(0.3713907f, 0.7427814f, 0.5570860f)};
  for (int i = 0; i < kMostSurfaces; ++i, ray.seed += kRaySeedStep) {
    const std::optional<Hit> hit = snapshot.intersector().closest(ray);
    if (!hit) break;
    const ObjectState& object = snapshot.object(hit->object);
    const Surface surface = surface_at(object, object.place, *hit);
    if (object.interior != nullptr) {
      const bool enters = ray.dir.dot(surface.normal_geometric) < 0.0f;
      if (enters) {
        entered.push_back(hit->object);
      } else if (std::erase(entered, hit->object) == 0) {
        around.push_back(hit->object);
      }
    }
    ray.origin = offset_origin(surface, ray.dir);
  }
  // A path to the point would have entered the outermost first.
  Interiors interiors;
  for (auto object = around.rbegin(); object != around.rend(); ++object) interiors.enter(*object);
  return interiors;
}

}  // namespace becalm::tracer
