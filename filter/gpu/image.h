#pragma once

#include <cstdint>

namespace becalm::gpu {

/// Element of a GPU image, as the kernels declare it: `float data[]`, `vec2 data[]`, `vec4 data[]`.
enum class Format { f32, f32x2, f32x4 };

constexpr std::uint64_t bytes_per_element(Format format) {
  switch (format) {
    case Format::f32:
      return 4;
    case Format::f32x2:
      return 8;
    case Format::f32x4:
      return 16;
  }
  return 0;
}

/// Size of an image or of a dispatch in pixels. An image has `planes` planes of this size, one after another.
struct Extent {
  int width = 0;
  int height = 0;
  int planes = 1;

  constexpr std::uint64_t elements() const {
    return std::uint64_t(width) * std::uint64_t(height) * std::uint64_t(planes);
  }
  constexpr Extent with_planes(int count) const { return {width, height, count}; }
  bool operator==(const Extent&) const = default;
};

/// Identifies an image of one Chain. Images are storage buffers, row-major, plane after plane (see README.md
/// for why).
struct ImageId {
  int index = -1;

  bool operator==(const ImageId&) const = default;
};

}  // namespace becalm::gpu
