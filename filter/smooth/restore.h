#pragma once

#include <string>

#include "filter/gpu/chain.h"

namespace becalm::filter {

/// The mean of `smoothed` and of `color`, of which the latter counts by `share`. Images of the extent `full`;
/// the share is f32 or the first of f32x2.
inline gpu::ImageId add_restore(gpu::Chain& chain, gpu::Extent full, const std::string& name,
                                gpu::ImageId color, gpu::ImageId smoothed, gpu::ImageId share) {
  const gpu::ImageId restored = chain.image(name, gpu::Format::f32x4, full);
  chain.pass("smooth/restore")
      .read("color", color)
      .read("smoothed", smoothed)
      .read("share", share)
      .write("restored", restored)
      .dispatch(full);
  return restored;
}

}  // namespace becalm::filter
