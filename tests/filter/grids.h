#pragma once

#include "filter/gpu/chain.h"
#include "tests/filter/reference/merge.h"

namespace becalm::filter {

/// Fills a chain's inputs with an estimate: its colours (f32x4), and its variances and counts (f32x2).
void upload_estimate(gpu::Chain& chain, gpu::ImageId color, gpu::ImageId stats,
                     const reference::Grid<reference::Estimate>& estimate);

/// Fills an input with offsets (f32x2).
void upload_offset(gpu::Chain& chain, gpu::ImageId image, const reference::Grid<reference::Vec2>& offset);

/// Such an estimate as a chain left it.
reference::Grid<reference::Estimate> download_estimate(const gpu::Chain& chain, gpu::ImageId color,
                                                       gpu::ImageId stats, gpu::Extent extent);

}  // namespace becalm::filter
