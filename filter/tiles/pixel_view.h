#pragma once

#include <span>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/tiles/tiles.h"
#include "frame/image.h"

namespace becalm::filter {

/// Host pixels of `channels` floats each, in the layout of a chain's uploads and downloads: plane by plane,
/// row by row.
template <class Float>
struct PixelView {
  std::span<Float> values;
  gpu::Extent extent;
  int channels = 1;
};

PixelView<float> view(Image& image);
PixelView<const float> view(const Image& image);

/// Copies `rect` of every plane of `from` to (x, y) in `to`, which has as many planes and channels.
void copy_rect(const PixelView<const float>& from, const Rect& rect, const PixelView<float>& to, int x,
               int y);

/// Copies the core of a tile's pixels into the frame's image. Does nothing if that image is empty.
void copy_core(std::span<const float> pixels, const Tile& tile, Image& image);
void copy_core(const std::vector<std::span<const float>>& pixels, const Tile& tile,
               std::vector<Image>& images);

/// Uploads a rectangle of `from` to an input of a chain.
void upload(gpu::Chain& chain, gpu::ImageId image, const PixelView<const float>& from, const Rect& rect);

/// Uploads the position of a tile's target rectangle in its source rectangle (f32x2, 1x1).
void upload_origin(gpu::Chain& chain, gpu::ImageId image, const Rect& target, const Rect& source);

/// An output of a chain: one plane of `extent` with `channels` floats a pixel.
Image download(const gpu::Chain& chain, gpu::ImageId image, gpu::Extent extent, int channels);

}  // namespace becalm::filter
