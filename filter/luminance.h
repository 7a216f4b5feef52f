#pragma once

#include <span>

namespace becalm::filter {

/// Rec.709 luminance, the same as in shaders/lib/color.glsl.
inline float luminance(std::span<const float> rgb) {
  return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
}

}  // namespace becalm::filter
