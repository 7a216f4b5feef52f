#include "filter/pixel_view.h"

#include <algorithm>
#include <cassert>

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
  for (int plane = 0; plane < from.extent.planes; ++plane) {
    for (int row = 0; row < rect.height; ++row) {
      std::ranges::copy(row_part(from, plane, rect.x, rect.y + row, rect.width),
                        row_part(to, plane, x, y + row, rect.width).begin());
    }
  }
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

}  // namespace becalm::filter
