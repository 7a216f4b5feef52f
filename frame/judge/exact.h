#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "frame/image.h"

namespace becalm::judge {

/// What files store, whose neighbouring values are one ulp apart.
enum class Stored { half, float32 };

/// One channel of one pixel that differs.
struct Difference {
  int x = 0;
  int y = 0;
  int channel = 0;
  float test = 0.0f;
  float reference = 0.0f;
  /// How many steps from one value to the next lie between the two; 0 between -0 and +0. Nothing where one of
  /// them is NaN.
  std::optional<std::uint64_t> ulps;
};

struct ExactResult {
  Stored stored = Stored::float32;
  std::size_t differing_pixels = 0;
  std::optional<Difference> first;  ///< in the order of rows, then columns, then channels
  /// Of most ulps, the first of equal ones; NaN against a number counts most.
  std::optional<Difference> largest;

  bool passed() const { return differing_pixels == 0; }
};

/// Compares the bits of all channels of images of equal shape. Any NaN equals any other: sign and payload of
/// a NaN depend on the order of operands, which compilers choose. -0 and +0 differ. With Stored::half, half
/// holds every value of both. Throws std::invalid_argument for different shapes.
ExactResult compare_exactly(const Image& test, const Image& reference, Stored stored = Stored::float32);

/// One line: how many pixels differ, and the first and the largest difference.
std::string describe(const ExactResult& result);

}  // namespace becalm::judge
