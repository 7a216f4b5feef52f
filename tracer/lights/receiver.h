#pragma once

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// The point of a path that light is drawn for.
struct Receiver {
  V3f position;
  /// Unit; only light from its side counts, by its cosine. 0 where light from everywhere counts alike: in
  /// media, and on surfaces that transmit.
  V3f normal;

  Receiver(const V3f& at, const V3f& facing = V3f(0.0f)) : position(at), normal(facing) {}

  bool faces() const { return !is_black(normal); }
};

}  // namespace becalm::tracer
