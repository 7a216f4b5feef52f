#include "filter/tiles/pixel_view.h"

#include <algorithm>
#include <cassert>

#include "filter/for_rows.h"

namespace becalm::filter {
namespace {

template <class Float>
std::span<Float> row_part(const PixelView<Float>& view, int plane, int x, int y, int width) {
  const std::size_t first =
      (static_cast<std::size_t>(plane) * view.extent.height + y) * view.extent.width + x;
  return view.values.subspan(first * view.channels, static_cast<std::size_t>(width) * view.channels);
}

}  // namespace

void copy_rect(const PixelView<const float>& from, const Rect& rect, const PixelView<float>& to, int x,
               int y) {
  assert(from.channels == to.channels && from.extent.planes == to.extent.planes);
  for_rows(rect.height * from.extent.planes, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const int plane = i / rect.height;
      const int row = i % rect.height;
      std::ranges::copy(row_part(from, plane, rect.x, rect.y + row, rect.width),
                        row_part(to, plane, x, y + row, rect.width).begin());
    }
  });
}

void copy_core(std::span<const float> pixels, const Tile& tile, Image& image) {
  if (image.empty()) return;
  copy_rect({pixels, tile.target.extent(), image.channels()}, within(tile.core, tile.target), view(image),
            tile.core.x, tile.core.y);
}

void copy_core(const std::vector<std::span<const float>>& pixels, const Tile& tile,
               std::vector<Image>& images) {
  for (std::size_t i = 0; i < images.size(); ++i) copy_core(pixels[i], tile, images[i]);
}

PixelView<float> view(Image& image) {
  return {image.data(), {image.width(), image.height()}, image.channels()};
}

PixelView<const float> view(const Image& image) {
  return {image.data(), {image.width(), image.height()}, image.channels()};
}

void upload(gpu::Chain& chain, gpu::ImageId image, const PixelView<const float>& from, const Rect& rect) {
  copy_rect(from, rect,
            {chain.upload<float>(image), rect.extent().with_planes(from.extent.planes), from.channels}, 0, 0);
}

void upload_origin(gpu::Chain& chain, gpu::ImageId image, const Rect& target, const Rect& source) {
  const std::span<float> origin = chain.upload<float>(image);
  origin[0] = static_cast<float>(target.x - source.x);
  origin[1] = static_cast<float>(target.y - source.y);
}

Image download(const gpu::Chain& chain, gpu::ImageId image, gpu::Extent extent, int channels) {
  Image result(extent.width, extent.height, channels, Unfilled());
  std::ranges::copy(chain.download<float>(image), result.data().begin());
  return result;
}

}  // namespace becalm::filter
