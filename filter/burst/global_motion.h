#pragma once

#include <Imath/ImathVec.h>

#include <array>

#include "frame/image.h"

namespace becalm::filter {

/// The motion of a still scene under a camera that turns and shifts: a homography to first order. Offsets
/// lead from the target to the source, in pixels of the features.
struct GlobalMotion {
  /// Of (x, y) from the middle, in halves of the longer side: dx = p0 + p1 x + p2 y + p6 x^2 + p7 x y,
  /// dy = p3 + p4 x + p5 y + p6 x y + p7 y^2.
  std::array<double, 8> p{};

  /// Of pixel (x, y) of features of this size, in their pixels.
  Imath::V2d offset(int x, int y, int width, int height) const;
};

/// Fits the motion of most of the picture: first to the offsets that the aligner found, where there is
/// texture; then to the features themselves, whose noise has a deviation of about 1, by Gauss-Newton steps
/// that count large differences less (Lucas and Kanade 1981). All images have one size.
GlobalMotion fit_global_motion(const Image& target, const Image& source, const Image& offset);

}  // namespace becalm::filter
