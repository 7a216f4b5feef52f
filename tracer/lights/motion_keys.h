#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Where the places of an emitter that moves during the shutter interval stand in the array of keys of its
/// kind: keys `first` to `first + segments`, at equally spaced times from 0 to 1, linear in between as the
/// geometry's. Without segments the emitter stands still, and what it says of its place itself holds.
struct MotionKeys {
  std::uint32_t first = 0;
  std::uint32_t segments = 0;

  bool moving() const { return segments > 0; }
};

/// The value between keys at `time` in [0,1]; `interpolate(a, b, t)` between two of them.
template <class Key, class Interpolate>
Key key_at(std::span<const Key> keys, const MotionKeys& motion, float time, const Interpolate& interpolate) {
  const float position = std::clamp(time, 0.0f, 1.0f) * static_cast<float>(motion.segments);
  const std::uint32_t segment = std::min(static_cast<std::uint32_t>(position), motion.segments - 1);
  const Key* key = &keys[std::size_t{motion.first} + segment];
  return interpolate(key[0], key[1], position - static_cast<float>(segment));
}

/// Exact at both ends, unlike a + t (b - a).
inline V3f interpolate_linear(const V3f& a, const V3f& b, float t) {
  return a * (1.0f - t) + b * t;
}

/// Mean over the shutter interval of a function of time, by Simpson's rule on each segment: exact for a
/// sphere's area.
template <class F>
double mean_over_shutter(const MotionKeys& motion, const F& value_at) {
  double sum = 0.0;
  for (std::uint32_t i = 0; i < motion.segments; ++i) {
    const auto at = [&](float offset) {
      return value_at((static_cast<float>(i) + offset) / static_cast<float>(motion.segments));
    };
    sum += (at(0.0f) + 4.0 * at(0.5f) + at(1.0f)) / 6.0;
  }
  return sum / motion.segments;
}

}  // namespace becalm::tracer
