#pragma once

#include <optional>
#include <string>

#include "filter/gpu/chain.h"

namespace becalm::filter {

/// Sums of f32x4 statistics over a patch of `radius`, 2 to 8, without the pixel in its middle.
gpu::ImageId add_box_sums(gpu::Chain& chain, int radius, gpu::Extent full, gpu::ImageId statistics,
                          const std::string& name);

/// What kernels that include shaders/lib/patch_sum.glsl read for such sums.
struct PatchSums {
  /// None for a radius of 1: the kernels read those pixels themselves, which is less than two more passes
  /// write.
  std::optional<gpu::ImageId> sums;
  gpu::Footprint reach;  ///< of the statistics
};

/// The same for a radius of 1 to 8.
PatchSums add_patch_sums(gpu::Chain& chain, int radius, gpu::Extent full, gpu::ImageId statistics,
                         const std::string& name);

}  // namespace becalm::filter
