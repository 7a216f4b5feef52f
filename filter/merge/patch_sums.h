#pragma once

#include <string>

#include "filter/gpu/chain.h"

namespace becalm::filter {

/// Sums of f32x4 statistics over the rows above and below in a patch of `radius`; kernels that take them add
/// the pixel's own row, without the pixel.
gpu::ImageId add_patch_sums(gpu::Chain& chain, int radius, gpu::Extent full, gpu::ImageId statistics,
                            const std::string& name);

}  // namespace becalm::filter
