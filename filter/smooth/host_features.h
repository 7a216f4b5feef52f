#pragma once

#include <array>

#include "filter/gpu/chain.h"
#include "filter/smooth/weights.h"

namespace becalm::filter {

/// Declares the host passes that compute the network's features of every scale by oneDNN, on devices that are
/// processors. On other devices shaders/smooth/convolve*.comp and pool.comp compute them. `inputs` has the
/// size `size`, a multiple of 2^(kScales - 1).
std::array<gpu::ImageId, kScales> add_host_features(gpu::Chain& chain, const NetworkWeights& weights,
                                                    gpu::Extent size, gpu::ImageId inputs);

}  // namespace becalm::filter
