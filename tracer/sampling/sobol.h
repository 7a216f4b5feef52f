#pragma once

#include <cstdint>

namespace becalm::tracer {

/// Avalanche of 64 bits, a bijection: the finaliser of SplitMix64 (Steele et al. 2014, Stafford's variant
/// 13).
inline std::uint64_t mix_bits(std::uint64_t v) {
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9ull;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebull;
  return v ^ (v >> 31);
}

/// Four numbers that one instruction works on. What follows is for one number or for four.
using Bits4 = std::uint32_t __attribute__((vector_size(16)));

inline std::uint32_t swap_bytes(std::uint32_t v) {
  return __builtin_bswap32(v);
}
inline Bits4 swap_bytes(Bits4 v) {
  using Bytes = std::uint8_t __attribute__((vector_size(16)));
  const auto bytes = reinterpret_cast<Bytes>(v);
  return reinterpret_cast<Bits4>(
      __builtin_shufflevector(bytes, bytes, 3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
}

template <class Bits>
Bits reverse_bits(Bits v) {
  v = (v & 0x55555555u) << 1 | (v >> 1 & 0x55555555u);
  v = (v & 0x33333333u) << 2 | (v >> 2 & 0x33333333u);
  v = (v & 0x0f0f0f0fu) << 4 | (v >> 4 & 0x0f0f0f0fu);
  return swap_bytes(v);
}

/// Hash in which each bit is changed by the seed and by lower bits alone, so that on a bit-reversed number it
/// is a nested uniform (Owen) scrambling. Laine and Karras 2011, with the constants of Vegdahl, "Building a
/// Better LK Hash", 2021: Burley's own leave visible structure.
template <class Bits>
Bits owen_hash(Bits v, Bits seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1u;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

/// Nested uniform scrambling in base 2, from the highest bit down. Maps aligned blocks of 2^k numbers onto
/// such blocks, so that as a permutation of sample indices it keeps every power-of-two prefix a (0,2)-net.
inline std::uint32_t owen_scramble(std::uint32_t v, std::uint32_t seed) {
  return reverse_bits(owen_hash(reverse_bits(v), seed));
}

/// Bit-reversed second coordinate of the index-th Sobol point. (The first coordinate, bit-reversed, is the
/// index itself.) The generator matrix is Pascal's triangle mod 2, which is a Kronecker power of [1 1; 0 1]:
/// one step a factor.
template <class Bits>
Bits sobol_1_reversed(Bits index) {
  index ^= index >> 16;
  index ^= index >> 8 & 0x00ff00ffu;
  index ^= index >> 4 & 0x0f0f0f0fu;
  index ^= index >> 2 & 0x33333333u;
  index ^= index >> 1 & 0x55555555u;
  return index;
}

/// The highest 24 bits as a float in [0,1).
inline float to_unit_float(std::uint32_t v) {
  return static_cast<float>(v >> 8) * 0x1p-24f;
}
inline auto to_unit_float(Bits4 v) {
  using Signed = std::int32_t __attribute__((vector_size(16)));
  using Floats = float __attribute__((vector_size(16)));
  return __builtin_convertvector(reinterpret_cast<Signed>(v >> 8), Floats) * 0x1p-24f;
}

/// The highest 53 bits as a double in [0,1).
inline double to_unit_double(std::uint64_t v) {
  return static_cast<double>(v >> 11) * 0x1p-53;
}

}  // namespace becalm::tracer
