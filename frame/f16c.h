#pragma once

// Half floats in vectors. Every processor with AVX2 converts them (F16C), rounding as Imath does; a
// signalling NaN becomes a quiet one. BECALM_WITH_F16C, where it is defined, marks functions that may be
// called if has_f16c().
#ifdef __x86_64__
#include <immintrin.h>

#include <cstddef>

#define BECALM_WITH_F16C __attribute__((target("avx2,f16c")))

namespace becalm {

/// Values of a vector.
inline constexpr std::size_t kF16cValues = 8;

inline bool has_f16c() {
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
}

}  // namespace becalm
#endif
