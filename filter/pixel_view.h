#pragma once

#include <span>

#include "filter/gpu/chain.h"
#include "filter/tiles.h"
#include "frame/image.h"

namespace becalm::filter {

/// Pixels of `channels` floats each on the host, row by row and plane after plane, as chains take and give
/// them.
template <class Float>
struct PixelView {
  std::span<Float> values;
  gpu::Extent extent;
  int channels = 1;
};

PixelView<float> view(Image& image);
PixelView<const float> view(const Image& image);

/// Copies a rectangle of every plane to (x, y) of images with as many planes and channels.
void copy_rect(const PixelView<const float>& from, const Rect& rect, const PixelView<float>& to, int x,
               int y);

/// Fills an input of a chain with a rectangle.
void upload(gpu::Chain& chain, gpu::ImageId image, const PixelView<const float>& from, const Rect& rect);

}  // namespace becalm::filter
