#include "frame/io/samples.h"

#include <half.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "frame/f16c.h"

namespace becalm::io {
namespace {

#ifdef BECALM_WITH_F16C
/// Converts as many halves as fill vectors, and returns their number.
BECALM_WITH_F16C std::size_t vectors_from_halves(const char* samples, std::span<float> values) {
  std::size_t i = 0;
  for (; i + kF16cValues <= values.size(); i += kF16cValues) {
    const __m128i halves = _mm_loadu_si128(reinterpret_cast<const __m128i*>(samples + 2 * i));
    _mm256_storeu_ps(&values[i], _mm256_cvtph_ps(halves));
  }
  return i;
}

/// Likewise to halves; adds to `overflows` the values beyond their range.
BECALM_WITH_F16C std::size_t vectors_to_halves(std::span<const float> values, char* samples,
                                               std::size_t& overflows) {
  const __m256 sign = _mm256_set1_ps(-0.0f);
  const __m256 largest = _mm256_set1_ps(HALF_MAX);
  const __m256 infinite = _mm256_set1_ps(HUGE_VALF);
  std::size_t i = 0;
  for (; i + kF16cValues <= values.size(); i += kF16cValues) {
    const __m256 value = _mm256_loadu_ps(&values[i]);
    const __m256 magnitude = _mm256_andnot_ps(sign, value);
    const __m256 beyond = _mm256_and_ps(_mm256_cmp_ps(magnitude, largest, _CMP_GT_OQ),
                                        _mm256_cmp_ps(magnitude, infinite, _CMP_LT_OQ));
    const __m256 limit = _mm256_or_ps(largest, _mm256_and_ps(sign, value));
    const __m128i halves = _mm256_cvtps_ph(_mm256_blendv_ps(value, limit, beyond), _MM_FROUND_TO_NEAREST_INT);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(samples + 2 * i), halves);
    overflows += static_cast<std::size_t>(__builtin_popcount(_mm256_movemask_ps(beyond)));
  }
  return i;
}
#endif

void from_halves(const char* samples, std::span<float> values) {
  std::size_t done = 0;
#ifdef BECALM_WITH_F16C
  if (has_f16c()) done = vectors_from_halves(samples, values);
#endif
  for (std::size_t i = done; i < values.size(); ++i) {
    std::uint16_t bits;
    std::memcpy(&bits, samples + sizeof bits * i, sizeof bits);
    values[i] = imath_half_to_float(bits);
  }
}

std::size_t to_halves(std::span<const float> values, char* samples) {
  std::size_t overflows = 0;
  std::size_t done = 0;
#ifdef BECALM_WITH_F16C
  if (has_f16c()) done = vectors_to_halves(values, samples, overflows);
#endif
  for (std::size_t i = done; i < values.size(); ++i) {
    float value = values[i];
    if (std::isfinite(value) && std::abs(value) > HALF_MAX) {
      ++overflows;
      value = std::copysign(HALF_MAX, value);
    }
    const std::uint16_t bits = imath_float_to_half(value);
    std::memcpy(samples + sizeof bits * i, &bits, sizeof bits);
  }
  return overflows;
}

std::uint32_t to_uint(float value) {
  constexpr double largest = 4294967295.0;
  return std::isnan(value) ? 0u
                           : static_cast<std::uint32_t>(std::clamp<double>(std::round(value), 0.0, largest));
}

}  // namespace

void from_samples(Imf::PixelType type, const char* samples, std::span<float> values) {
  if (type == Imf::HALF) return from_halves(samples, values);
  std::memcpy(values.data(), samples, values.size_bytes());
  if (type != Imf::UINT) return;
  for (float& value : values) value = static_cast<float>(std::bit_cast<std::uint32_t>(value));
}

std::size_t to_samples(Imf::PixelType type, std::span<const float> values, char* samples) {
  if (type == Imf::HALF) return to_halves(values, samples);
  if (type != Imf::UINT) {
    std::memcpy(samples, values.data(), values.size_bytes());
    return 0;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint32_t number = to_uint(values[i]);
    std::memcpy(samples + sizeof number * i, &number, sizeof number);
  }
  return 0;
}

}  // namespace becalm::io
