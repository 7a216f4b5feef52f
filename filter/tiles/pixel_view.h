#pragma once

#include <span>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/tiles/tiles.h"
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

/// Copies the core of a tile's pixels into a frame's image, if that is not empty.
void copy_core(std::span<const float> pixels, const Tile& tile, Image& image);
void copy_core(const std::vector<std::span<const float>>& pixels, const Tile& tile,
               std::vector<Image>& images);

/// Fills an input of a chain with a rectangle.
void upload(gpu::Chain& chain, gpu::ImageId image, const PixelView<const float>& from, const Rect& rect);

}  // namespace becalm::filter
