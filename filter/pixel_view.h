#pragma once

#include <span>

#include "filter/gpu/image.h"
#include "filter/tiles.h"

namespace becalm::filter {

/// Pixels of `channels` floats each on the host, row by row and plane after plane, as chains take and give
/// them.
template <class Float>
struct PixelView {
  std::span<Float> values;
  gpu::Extent extent;
  int channels = 1;
};

/// Copies a rectangle of every plane to (x, y) of images with as many planes and channels.
void copy_rect(const PixelView<const float>& from, const Rect& rect, const PixelView<float>& to, int x,
               int y);

}  // namespace becalm::filter
