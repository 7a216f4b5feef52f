#pragma once

#include "filter/gpu/chain.h"

namespace becalm::filter {

/// Features that a pixel's surroundings are explained by, at full resolution, as pack_features gives them.
struct SurfaceImages {
  gpu::ImageId albedo_depth;  ///< f32x4: albedo, and depth brought to [0,2]
  gpu::ImageId normal;        ///< f32x4: normal, 0

  bool operator==(const SurfaceImages&) const = default;
};

}  // namespace becalm::filter
