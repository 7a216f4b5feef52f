#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "tracer/math/vec.h"
#include "tracer/sampling/sobol.h"

namespace becalm::tracer {

/// As many random numbers as tracking through a medium may need, from two numbers of the path's sampler:
/// those two come first, stratified as they are, then a SplitMix64 stream that they seed. So an image stays a
/// pure function of (seed, frame, pixel, sample), however many numbers a path takes here.
class MediumRandom {
 public:
  /// u in [0,1)^2.
  explicit MediumRandom(const V2f& u)
      : u_(u),
        state_(mix_bits(std::uint64_t{std::bit_cast<std::uint32_t>(u.x)} << 32 |
                        std::bit_cast<std::uint32_t>(u.y))) {}

  /// In [0,1).
  float next() {
    const std::uint32_t index = count_++;
    if (index < 2) return index == 0 ? u_.x : u_.y;
    return to_unit_float(static_cast<std::uint32_t>(mix_bits(state_ += 0x9e3779b97f4a7c15ull) >> 32));
  }

  /// Exponentially distributed with mean 1, from 2^-25 to 17.33: the middles of 2^24 intervals of equal
  /// probability, exact at both ends, so that it is never 0 and a thin medium is not hit too often.
  float next_exponential() {
    const float u = next();
    return u < 0.5f ? -std::log1p(-(u + 0x1p-25f)) : -std::log((1.0f - u) - 0x1p-25f);
  }

 private:
  V2f u_;
  std::uint64_t state_;
  std::uint32_t count_ = 0;
};

}  // namespace becalm::tracer
