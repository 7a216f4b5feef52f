#include "filter/sequence/half_values.h"

#include <half.h>

#include <cmath>

#include "frame/f16c.h"

namespace becalm::filter {
namespace {

#ifdef BECALM_WITH_F16C
BECALM_WITH_F16C std::uint32_t to_halves_in_vectors(const float* values, const float* factors,
                                                    float largest_error, std::uint16_t* halves) {
  const __m256 magnitude = _mm256_castsi256_ps(_mm256_set1_epi32(0x7fffffff));
  const __m256 limit = _mm256_set1_ps(largest_error);
  std::uint32_t missed = 0;
  for (std::size_t i = 0; i < kHalfBlock; i += kF16cValues) {
    const __m256 value = _mm256_loadu_ps(values + i);
    const __m256 factor = _mm256_loadu_ps(factors + i);
    const __m128i half = _mm256_cvtps_ph(_mm256_mul_ps(value, factor), _MM_FROUND_TO_NEAREST_INT);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(halves + i), half);
    const __m256 back = _mm256_div_ps(_mm256_cvtph_ps(half), factor);
    const __m256 error = _mm256_and_ps(_mm256_sub_ps(back, value), magnitude);
    const __m256 allowed = _mm256_mul_ps(limit, _mm256_and_ps(value, magnitude));
    const __m256 misses = _mm256_cmp_ps(error, allowed, _CMP_NLE_UQ);  // also if not a number
    missed |= static_cast<std::uint32_t>(_mm256_movemask_ps(misses)) << i;
  }
  return missed;
}

BECALM_WITH_F16C void from_halves_in_vectors(const std::uint16_t* halves, const float* factors,
                                             float* values) {
  for (std::size_t i = 0; i < kHalfBlock; i += kF16cValues) {
    const __m128i half = _mm_loadu_si128(reinterpret_cast<const __m128i*>(halves + i));
    _mm256_storeu_ps(values + i, _mm256_div_ps(_mm256_cvtph_ps(half), _mm256_loadu_ps(factors + i)));
  }
}
#endif

}  // namespace

std::uint32_t to_halves(const float* values, const ChannelFactors& factors, float largest_error,
                        std::uint16_t* halves) {
#ifdef BECALM_WITH_F16C
  if (has_f16c()) return to_halves_in_vectors(values, factors.data(), largest_error, halves);
#endif
  std::uint32_t missed = 0;
  for (std::size_t i = 0; i < kHalfBlock; ++i) {
    halves[i] = imath_float_to_half(values[i] * factors.data()[i]);
    const float back = imath_half_to_float(halves[i]) / factors.data()[i];
    if (!(std::abs(back - values[i]) <= largest_error * std::abs(values[i]))) missed |= 1U << i;
  }
  return missed;
}

void from_halves(const std::uint16_t* halves, const ChannelFactors& factors, float* values) {
#ifdef BECALM_WITH_F16C
  if (has_f16c()) return from_halves_in_vectors(halves, factors.data(), values);
#endif
  for (std::size_t i = 0; i < kHalfBlock; ++i) values[i] = imath_half_to_float(halves[i]) / factors.data()[i];
}

}  // namespace becalm::filter
