#pragma once

#include <string>

#include "filter/gpu/chain.h"

namespace becalm::filter {

/// Sums of f32x4 statistics over a patch of `radius` without the pixel's own row. Kernels that read them add
/// that row, without the pixel.
gpu::ImageId add_patch_sums(gpu::Chain& chain, int radius, gpu::Extent full, gpu::ImageId statistics,
                            const std::string& name);

}  // namespace becalm::filter
