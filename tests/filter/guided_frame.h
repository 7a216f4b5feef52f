#pragma once

#include <algorithm>
#include <array>

#include "frame/frame.h"

namespace becalm::filter {

/// A pixel's features: a surface that faces the z axis, or nothing (a normal of 0).
struct SurfacePixel {
  std::array<float, 3> albedo;
  float normal_z;
  float depth;
};

/// A frame with the albedo, normal and depth of `surface_at(x, y)`, a SurfacePixel; its beauty is 1 and its
/// variance 0 until the caller sets them.
template <class SurfaceAt>
Frame guided_frame(int number, int width, int height, const SurfaceAt& surface_at) {
  Frame frame(number, width, height);
  frame.add(Aov::beauty, 1.0f);
  for (const Aov aov : {Aov::variance, Aov::albedo, Aov::normal, Aov::depth}) frame.add(aov);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const SurfacePixel surface = surface_at(x, y);
      std::ranges::copy(surface.albedo, frame.image(Aov::albedo).pixel(x, y).begin());
      frame.image(Aov::normal).at(x, y, 2) = surface.normal_z;
      frame.image(Aov::depth).at(x, y, 0) = surface.depth;
    }
  }
  return frame;
}

}  // namespace becalm::filter
