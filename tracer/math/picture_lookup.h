#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "tracer/math/vec.h"

namespace becalm::tracer {

/// v less its whole part; 0 for what is not finite.
inline float fraction_of(float v) {
  const float fraction = v - std::floor(v);
  return std::isfinite(fraction) ? fraction : 0.0f;
}

/// How copies of a picture lie over uv: it is read at uv * repeat + offset, less the whole parts.
struct PicturePlacement {
  V2f repeat{1.0f};  ///< copies over the unit square
  V2f offset{0.0f};  ///< in pictures

  V2f operator()(const V2f& uv) const { return uv * repeat + offset; }
};

/// Where a place among copies, whose y runs up, stands on the picture: (s, t) in [0,1] from the top left
/// corner.
inline V2f picture_point(const V2f& place) {
  return {fraction_of(place.x), 1.0f - fraction_of(place.y)};
}

/// What stands above the top row and below the bottom one.
enum class PictureRows { repeat, hold };

/// The four texels around a position, numbered row by row from the top, and how far it is from the first.
struct TexelsAround {
  std::size_t upper_left, upper_right, lower_left, lower_right;
  float share_right, share_lower;

  /// Linear between what texel(number) gives: a number, or a vector of them.
  template <class Texel>
  auto mix(const Texel& texel) const {
    // In this form the mean of equal texels is exact.
    const auto between = [](const auto& low, const auto& high, float share) {
      return low + share * (high - low);
    };
    return between(between(texel(upper_left), texel(upper_right), share_right),
                   between(texel(lower_left), texel(lower_right), share_right), share_lower);
  }
};

/// `position` is in texels from the top left corner of the picture, on or in it; columns repeat.
template <PictureRows kRows = PictureRows::repeat>
TexelsAround texels_around(int width, int height, const V2f& position) {
  const float x = position.x - 0.5f, y = position.y - 0.5f;
  const float floor_x = std::floor(x), floor_y = std::floor(y);
  const auto wrap = [](int i, int size) { return i < 0 ? i + size : i >= size ? i - size : i; };
  const auto row_at = [&](int row) {
    return kRows == PictureRows::repeat ? wrap(row, height) : std::clamp(row, 0, height - 1);
  };
  const int x0 = wrap(static_cast<int>(floor_x), width), x1 = wrap(x0 + 1, width);
  const int y0 = row_at(static_cast<int>(floor_y)), y1 = row_at(static_cast<int>(floor_y) + 1);
  const auto number = [&](int column, int row) { return static_cast<std::size_t>(row) * width + column; };
  return {number(x0, y0), number(x1, y0), number(x0, y1), number(x1, y1), x - floor_x, y - floor_y};
}

/// Linear between the four texels around the position. `kChannels` numbers a texel, rows from the top.
template <std::size_t kChannels, PictureRows kRows = PictureRows::repeat, class Number>
std::array<float, kChannels> bilinear(const Number* texels, int width, int height, const V2f& position) {
  const TexelsAround around = texels_around<kRows>(width, height, position);
  std::array<float, kChannels> values;
  for (std::size_t i = 0; i < kChannels; ++i) {
    values[i] =
        around.mix([&](std::size_t texel) { return static_cast<float>(texels[texel * kChannels + i]); });
  }
  return values;
}

}  // namespace becalm::tracer
