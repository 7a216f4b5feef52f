#pragma once

#include <cstdint>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// Digits of the index mirrored at the point, in [0,1): the Halton sequence's coordinate of that prime base.
inline double radical_inverse(std::uint32_t index, std::uint32_t base) {
  double value = 0.0, digit = 1.0;
  for (; index > 0; index /= base) {
    digit /= base;
    value += digit * (index % base);
  }
  return value;
}

/// Subpixel positions shared by all pixels of a frame, as temporal antialiasing asks for: the Halton sequence
/// in bases 2 and 3, from its index 1 on, repeated after `cycle` points (Yang et al. 2020, section 3.1). One
/// frame of n samples takes the next n points, or all of its samples one point.
struct Jitter {
  std::uint32_t cycle = 0;  ///< 0: none, every pixel and frame has its own positions
  bool one_a_frame = false;

  /// How many different points a frame of `spp` samples has.
  std::uint32_t points(std::uint32_t spp) const { return one_a_frame ? 1 : spp; }

  /// In [0,1)^2, for sample `sample` of `spp` of frame number `frame` of the shot.
  V2f point(std::int64_t frame, std::uint32_t spp, std::uint32_t sample) const {
    const auto n = static_cast<std::int64_t>(cycle);
    if (one_a_frame) {
      spp = 1;
      sample = 0;
    }
    const std::int64_t position = (frame % n * (spp % n) + sample) % n;
    const auto index = static_cast<std::uint32_t>((position + n) % n) + 1;
    return {static_cast<float>(radical_inverse(index, 2)), static_cast<float>(radical_inverse(index, 3))};
  }
};

}  // namespace becalm::tracer
