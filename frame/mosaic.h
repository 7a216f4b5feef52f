#pragma once

#include <array>
#include <cstdint>

#include "frame/image.h"

namespace becalm {

/// The colours of a sensor's filters, which repeat every `period` pixels: 2 (Bayer) or 6 (X-Trans).
struct CfaPattern {
  int period = 2;
  std::array<std::uint8_t, 36> colors{0, 1, 1, 2};  ///< row-major; 0 red, 1 green, 2 blue

  int color(int x, int y) const { return colors[(y % period) * period + x % period]; }
  /// Side of the smallest squares that hold all colours, and in which the aligner sees one pixel.
  int block() const { return period / 2 + (period == 2 ? 1 : 0); }
  bool operator==(const CfaPattern&) const = default;
};

/// Variance of a sample as a function of its expected value: a * signal + b, where 0 is black and 1 is white.
struct NoiseModel {
  double a = 0.0;
  double b = 0.0;
};

/// One sample a pixel, as a sensor has them: 0 is black (noise may be below), 1 is white.
struct Mosaic {
  Image samples;  ///< one channel
  CfaPattern cfa;
};

}  // namespace becalm
