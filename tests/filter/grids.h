#pragma once

#include "filter/gpu/chain.h"
#include "tests/filter/reference/merge.h"

namespace becalm::filter {

/// Uploads an estimate to a chain's inputs: colours (f32x4), and variances and counts (f32x2).
void upload_estimate(gpu::Chain& chain, gpu::ImageId color, gpu::ImageId stats,
                     const reference::Grid<reference::Estimate>& estimate);

/// Uploads offsets to an input (f32x2).
void upload_offset(gpu::Chain& chain, gpu::ImageId image, const reference::Grid<reference::Vec2>& offset);

/// Downloads such an estimate from a chain's outputs.
reference::Grid<reference::Estimate> download_estimate(const gpu::Chain& chain, gpu::ImageId color,
                                                       gpu::ImageId stats, gpu::Extent extent);

}  // namespace becalm::filter
