#pragma once

#include "filter/gpu/chain.h"
#include "filter/input/noisy_inputs.h"

namespace becalm::filter {

struct DetailShare {
  gpu::ImageId share;  ///< f32x2: (share of the frame that is put back, mean relative variance around)
  gpu::ImageId stats;  ///< f32x2: (variance that then remains; 1, or 0 for a non-finite pixel)
};

/// How much of a frame is put back into its smoothed `color`, since patches of it lost more than noise.
/// `stats` is the squared error that the network expects.
DetailShare add_detail_share(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& frame,
                             gpu::ImageId color, gpu::ImageId stats);

}  // namespace becalm::filter
