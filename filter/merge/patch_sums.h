#pragma once

#include <optional>
#include <string>

#include "filter/gpu/chain.h"

namespace becalm::filter {

/// What kernels that include shaders/lib/patch_row.glsl read for the sums of statistics over a patch.
struct PatchSums {
  /// Of the rows above and below each pixel. None for a radius of 1: the kernels read those rows themselves,
  /// which is less than two more passes write.
  std::optional<gpu::ImageId> of_other_rows;
  gpu::Footprint reach;  ///< of the statistics
};

/// Sums of f32x4 statistics over a patch of `radius` without the pixel's own row. Kernels that read them add
/// that row, without the pixel.
PatchSums add_patch_sums(gpu::Chain& chain, int radius, gpu::Extent full, gpu::ImageId statistics,
                         const std::string& name);

}  // namespace becalm::filter
