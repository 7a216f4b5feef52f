#pragma once

#include <string>
#include <vector>

#include "frame/io/additive_layers.h"
#include "frame/io/layers.h"

namespace becalm::io {

/// Whether the layer is also read as direct or indirect light, which is denoised anyway.
bool is_denoised_aov(const ViewLayers& view, const LayerSource& layer);

/// Reads the layers of a file's sets and finds how well each adds up to the beauty. Layers that are AOVs
/// leave their set after that. Of sets of which one holds the other only one stays: the larger that adds up,
/// else the smaller that does, else the larger. Returns whether the frame tells anything: not if it is black.
bool compare_sums(const std::string& path, std::vector<AdditiveSet>& sets, const LayerOptions& options);

}  // namespace becalm::io
