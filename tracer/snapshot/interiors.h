#pragma once

#include <array>
#include <cstdint>

#include "tracer/snapshot/surface.h"

namespace becalm::tracer {

/// The objects with a medium in them that a point of a path lies in. The one entered last fills the overlap.
/// Deeper nesting than kMost is not tracked: the objects entered beyond it count as empty.
class Interiors {
 public:
  static constexpr int kMost = 4;

  void enter(std::uint32_t object) {
    if (contains(object) || count_ == kMost) return;
    objects_[count_++] = object;
  }
  void leave(std::uint32_t object) {
    for (int i = 0; i < count_; ++i) {
      if (objects_[i] != object) continue;
      --count_;
      for (; i < count_; ++i) objects_[i] = objects_[i + 1];
      return;
    }
  }
  bool empty() const { return count_ == 0; }
  /// The object whose medium fills the point; not to be called when empty.
  std::uint32_t innermost() const { return objects_[count_ - 1]; }
  bool contains(std::uint32_t object) const {
    for (int i = 0; i < count_; ++i) {
      if (objects_[i] == object) return true;
    }
    return false;
  }

 private:
  std::array<std::uint32_t, kMost> objects_{};
  int count_ = 0;
};

/// Updates `interiors` for light that crosses the object's surface in that direction.
inline void cross_boundary(Interiors& interiors, const ObjectState& object, std::uint32_t number,
                           const V3f& dir_world, const Surface& surface) {
  if (object.interior == nullptr) return;
  if (dir_world.dot(surface.normal_geometric) < 0.0f) {
    interiors.enter(number);
  } else {
    interiors.leave(number);
  }
}

/// The objects with a medium around a point when the shutter opens: those that a ray from it leaves without
/// having entered them.
Interiors interiors_at(const Snapshot& snapshot, const V3f& point);

}  // namespace becalm::tracer
