#pragma once

#include "filter/gpu/chain.h"

namespace becalm::filter {

/// Feature images at full resolution, in the format of pack_features.
struct SurfaceImages {
  gpu::ImageId albedo_depth;  ///< f32x4: albedo, and depth mapped to [0,2]
  gpu::ImageId normal;        ///< f32x4: normal, 0

  bool operator==(const SurfaceImages&) const = default;
};

}  // namespace becalm::filter
