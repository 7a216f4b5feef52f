#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <tuple>
#include <type_traits>

#include "tracer/math/vec.h"
#include "tracer/sampling/sobol.h"

namespace becalm::tracer {

/// Random numbers in [0,1) for one sample of one pixel: a pure function of (seed, frame, pixel, sample,
/// dimension), whatever was drawn elsewhere. Every call takes the next dimensions. Over the samples 0..2^k-1
/// of a pixel each next_1d() is stratified in 2^k intervals, and each next_2d() in every grid of 2^i x
/// 2^(k-i) boxes; different calls, pixels, frames and seeds are independent. Any aligned block of 2^j samples
/// is as well stratified, so disjoint halves are best taken as first and second half.
///
/// Source: Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020: two Sobol dimensions with nested
/// uniform scrambling, padded to any number of dimensions by shuffling the sample index for each call.
class Sampler {
 public:
  Sampler(std::uint32_t seed, int frame, int x, int y, std::uint32_t sample)
      : key_(mix_bits(mix_bits(pack(seed, static_cast<std::uint32_t>(frame))) ^
                      pack(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)))),
        sample_(sample) {}

  /// A number of this sample that is none of its dimensions, for the random choices of ray queries.
  std::uint32_t seed_of_rays() const {
    return high(mix_bits(key_ ^ (std::uint64_t{sample_} << 32 | 0xa11fau)));
  }

  float next_1d() {
    const std::uint64_t bits = next_bits();
    const std::uint32_t index = owen_scramble(sample_, low(bits));
    return to_unit_float(reverse_bits(owen_hash(index, high(bits))));
  }

  V2f next_2d() {
    const std::uint64_t bits_x = next_bits();
    const std::uint64_t bits_y = next_bits();
    const std::uint32_t index = owen_scramble(sample_, low(bits_x));
    return {to_unit_float(reverse_bits(owen_hash(index, high(bits_x)))),
            to_unit_float(reverse_bits(owen_hash(sobol_1_reversed(index), low(bits_y))))};
  }

  /// What as many calls in this order return, next_1d() for a float and next_2d() for a V2f, in less time.
  template <class... Numbers>
  std::tuple<Numbers...> next() {
    constexpr std::size_t lanes = (dimensions<Numbers>() + ...), padded = (lanes + 3) / 4 * 4;
    alignas(16) std::array<std::uint32_t, padded> shuffle{}, scramble{}, is_second{};
    std::size_t lane = 0;
    const auto add_call = [&](std::size_t count) {
      const std::uint64_t bits = next_bits();
      shuffle[lane] = low(bits);
      scramble[lane++] = high(bits);
      if (count == 1) return;
      shuffle[lane] = low(bits);
      is_second[lane] = ~0u;
      scramble[lane++] = low(next_bits());
    };
    (add_call(dimensions<Numbers>()), ...);
    alignas(16) std::array<float, padded> values;
    const Bits4 sample = Bits4{} + reverse_bits(sample_);
    for (std::size_t i = 0; i < padded; i += 4) {
      const Bits4 index = reverse_bits(owen_hash(sample, load(&shuffle[i])));
      const Bits4 second = load(&is_second[i]);
      const Bits4 point = (index & ~second) | (sobol_1_reversed(index) & second);
      const auto four = to_unit_float(reverse_bits(owen_hash(point, load(&scramble[i]))));
      std::memcpy(&values[i], &four, sizeof(four));
    }
    lane = 0;
    return {take<Numbers>(values.data(), lane)...};  // in this order, as braces have it
  }

 private:
  template <class Number>
  static constexpr std::size_t dimensions() {
    static_assert(std::is_same_v<Number, float> || std::is_same_v<Number, V2f>);
    return sizeof(Number) / sizeof(float);
  }
  template <class Number>
  static Number take(const float* values, std::size_t& lane) {
    const float* own = values + lane;
    lane += dimensions<Number>();
    if constexpr (dimensions<Number>() == 1) {
      return *own;
    } else {
      return {own[0], own[1]};
    }
  }
  static Bits4 load(const std::uint32_t* numbers) {
    Bits4 four;
    std::memcpy(&four, numbers, sizeof(four));
    return four;
  }
  static std::uint64_t pack(std::uint32_t hi, std::uint32_t lo) {
    return static_cast<std::uint64_t>(hi) << 32 | lo;
  }
  static std::uint32_t low(std::uint64_t bits) { return static_cast<std::uint32_t>(bits); }
  static std::uint32_t high(std::uint64_t bits) { return static_cast<std::uint32_t>(bits >> 32); }

  /// Scrambling seeds of the next dimension: a SplitMix64 stream that starts at the pixel's key.
  std::uint64_t next_bits() { return mix_bits(key_ + ++dimension_ * 0x9e3779b97f4a7c15ull); }

  std::uint64_t key_;
  std::uint32_t sample_;
  std::uint32_t dimension_ = 0;
};

}  // namespace becalm::tracer
