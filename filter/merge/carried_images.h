#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/tiles/tiles.h"
#include "frame/image.h"

namespace becalm::filter {

// Images that are merged with the beauty's weights, four channels each: additive AOVs and noisy layers.

/// `count` inputs of a chain (f32x4), named `name` and their number.
std::vector<gpu::ImageId> carried_inputs(gpu::Chain& chain, std::size_t count, gpu::Extent extent,
                                         const std::string& name);

/// Uploads a rectangle of `images` to such inputs.
void upload_carried(gpu::Chain& chain, const std::vector<gpu::ImageId>& inputs,
                    const std::vector<Image>& images, const Rect& rect);

/// Pixels of a chain's outputs for carried images; empty if there are none.
std::vector<std::span<const float>> download_carried(const gpu::Chain& chain,
                                                     const std::vector<gpu::ImageId>& images);

}  // namespace becalm::filter
