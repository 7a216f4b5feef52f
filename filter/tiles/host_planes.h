#pragma once

#include <span>
#include <vector>

#include "filter/tiles/pixel_view.h"

namespace becalm::filter {

/// An image of a whole frame on the host, as planes of one float a pixel. Chains that work tile by tile make
/// it or read it.
struct HostPlanes {
  HostPlanes() = default;
  explicit HostPlanes(gpu::Extent size) : extent(size), values(size.elements()) {}
  PixelView<float> view() { return {values, extent}; }
  PixelView<const float> view() const { return {values, extent}; }
  PixelView<const float> first_planes(int planes) const {
    const gpu::Extent part = extent.with_planes(planes);
    return {std::span(values).first(part.elements()), part};
  }

  gpu::Extent extent;
  std::vector<float> values;
};

}  // namespace becalm::filter
