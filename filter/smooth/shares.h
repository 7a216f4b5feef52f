#pragma once

#include <vector>

#include "filter/gpu/chain.h"
#include "filter/input/noisy_inputs.h"
#include "filter/smooth/weights.h"

namespace becalm::filter {

/// How a merged frame's result is mixed, and what remains as error.
struct Shares {
  gpu::ImageId of_frame;  ///< f32: of the frame itself, in its mix with the smoothed merged frame
  gpu::ImageId of_alone;  ///< f32: of the frame smoothed alone, in its mix with that
  gpu::ImageId stats;     ///< f32x2: (expected squared error, valid)
};

/// Finds the shares of three estimates of a frame, which sum to 1: the smoothed merged frame `merged`, the
/// frame itself and the frame smoothed alone. Merging and smoothing blur detail that the others have; where
/// much of it is noise, they have little. Trained layers tell the shares from the errors that the network
/// expects and from the differences of the three. `error` is that of `merged`, f32x2 as `stats`; `weights`
/// are packed by pack_shares.
Shares add_shares(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& frame, gpu::ImageId merged,
                  gpu::ImageId error, gpu::ImageId weights);

/// The layers' weights as shaders/smooth/shares.comp reads them.
std::vector<float> pack_shares(const ShareWeights& layers);

}  // namespace becalm::filter
