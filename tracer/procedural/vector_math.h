#pragma once

#include <bit>
#include <cstdint>

// Transcendental functions as straight arithmetic, so that plain loops over them vectorise and give the same
// bits on every machine. Polynomials interpolate at Chebyshev nodes.

namespace becalm::tracer {

struct SinCos {
  float sin, cos;
};

/// Sine and cosine of 2 pi `turns`, within 2e-7 beyond what the rounding of `turns` itself costs.
/// |turns| < 2^20.
inline SinCos sin_cos_turns(float turns) {
  // Adding 1.5 * 2^23 rounds to the next integer and leaves that in the low bits.
  const float half_turns = 2.0f * turns;
  const float shifted = half_turns + 12582912.0f;
  const float y = half_turns - (shifted - 12582912.0f);  // in [-1/2, 1/2]
  const float z = y * y;
  const float s =
      y * (3.14159264f + z * (-5.16771008f + z * (2.55007739f + z * (-0.598290411f + z * 0.0776559123f))));
  const float c = 1.0f + z * (-4.9347928f + z * (4.05841079f + z * (-1.33187297f + z * 0.219682424f)));
  const std::uint32_t sign = std::bit_cast<std::uint32_t>(shifted) << 31;
  return {std::bit_cast<float>(std::bit_cast<std::uint32_t>(s) ^ sign),
          std::bit_cast<float>(std::bit_cast<std::uint32_t>(c) ^ sign)};
}

/// 2^x within 3e-7 of its value for x in [-126, 127]; below that range it is 2^-126.
inline float exp2_fast(float x) {
  const float bounded = x > -126.0f ? x : -126.0f;
  const float shifted = bounded + 12582912.0f;
  const float y = bounded - (shifted - 12582912.0f);
  const float fraction =
      1.0f + y * (0.693147188f +
                  y * (0.240221075f + y * (0.0555035711f + y * (0.00967603192f + y * 0.00133908634f))));
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(fraction) +
                              (std::bit_cast<std::uint32_t>(shifted) << 23));
}

}  // namespace becalm::tracer
