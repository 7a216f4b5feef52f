#pragma once

#include <array>

#include "filter/gpu/chain.h"
#include "filter/smooth/weights.h"

namespace becalm::filter {

/// Declares the passes that make the network's features of every scale by oneDNN, where the device is a
/// processor: what shaders/smooth/convolve*.comp and pool.comp do elsewhere. `inputs` has `size`, which
/// every scale divides.
std::array<gpu::ImageId, kScales> add_host_features(gpu::Chain& chain, const NetworkWeights& weights,
                                                    gpu::Extent size, gpu::ImageId inputs);

}  // namespace becalm::filter
