#pragma once

#include <Imath/ImathBox.h>

#include <cmath>
#include <optional>

namespace becalm {

/// The ratio of the sides of an output to those of its input, from 1 to 4. Pixels of both are aligned to the
/// point (0, 0) of the image plane.
struct Scale {
  int numerator = 1;
  int denominator = 1;  ///< 1 to kMostDenominator

  static constexpr int kMostDenominator = 1000;
  bool is_one() const { return numerator == denominator; }
  double value() const { return static_cast<double>(numerator) / denominator; }
  /// The output's pixel edge nearest to an edge of the input, the larger one of two.
  int edge(int input) const { return static_cast<int>(std::floor(input * value() + 0.5)); }
  /// How far the output's edge lies beyond that edge of the input, in output pixels: -0.5 to 0.5.
  double rounding(int input) const { return edge(input) - input * value(); }
  Imath::Box2i window(const Imath::Box2i& input) const {
    return {{edge(input.min.x), edge(input.min.y)}, {edge(input.max.x + 1) - 1, edge(input.max.y + 1) - 1}};
  }
  bool operator==(const Scale&) const = default;
};

/// The pixels of a checkerboard frame that hold samples: those whose x + y is even, or odd.
enum class Parity { even, odd };

inline bool has_sample(Parity parity, int x, int y) {
  return ((x + y) & 1) == (parity == Parity::odd ? 1 : 0);
}

/// Finds the sample that lies nearest to a pixel of the scaled image, where all samples of the input lie
/// `position_px` from the centres of their pixels. Coordinates are those of whole images whose first pixels
/// are those of the input's window and of the scaled window.
struct NearestSample {
  Scale scale;
  Imath::Box2i window;  ///< of the input
  Imath::V2f position_px{0.0f, 0.0f};
  std::optional<Parity> checkerboard = {};  ///< in coordinates of the window

  /// Place of an output pixel's centre along an axis, in input pixels from the centre of the first one.
  double place(int output, int axis) const {
    return (output + scale.rounding(window.min[axis]) + 0.5) / scale.value() - 0.5;
  }
  Imath::V2i at(int x, int y) const {
    const Imath::V2i size = window.size() + Imath::V2i(1);
    const double from_x = place(x, 0) - position_px.x;
    const double from_y = place(y, 1) - position_px.y;
    Imath::V2i found(inside(std::round(from_x), size.x), inside(std::round(from_y), size.y));
    if (!checkerboard || has_sample(*checkerboard, found.x, found.y)) return found;
    // All four neighbours have samples: the one towards the place, along the axis on which it is off more.
    const double dx = from_x - found.x;
    const double dy = from_y - found.y;
    if ((std::abs(dx) >= std::abs(dy) && size.x > 1) || size.y == 1) {
      found.x += step(dx, found.x, size.x);
    } else {
      found.y += step(dy, found.y, size.y);
    }
    return found;
  }

 private:
  static int inside(double place, int size) {
    return static_cast<int>(std::fmin(std::fmax(place, 0.0), size - 1.0));
  }
  /// To the neighbour on the side of `distance` that exists; 0 in an image of one pixel.
  static int step(double distance, int at, int size) {
    if (size == 1) return 0;
    const int side = distance < 0.0 ? -1 : 1;
    return at + side >= 0 && at + side < size ? side : -side;
  }
};

}  // namespace becalm
