#pragma once

#include <vector>

#include "filter/gpu/chain.h"
#include "filter/input/noisy_inputs.h"
#include "filter/smooth/weights.h"

namespace becalm::filter {

/// The share of the frame itself in a merged frame's output, f32, and the squared error that is expected
/// then, f32x2 with (error, valid).
struct OwnShare {
  gpu::ImageId share;
  gpu::ImageId stats;
};

/// How much of the frame itself the output takes. Merging and smoothing blur detail that the frame has; where
/// much of it is noise, it has little. Trained layers tell the share from the error that the network expects,
/// the noise of the merged frame and the difference of both. `merged` is the smoothed merged frame with its
/// expected error, f32x2 as `stats`; `weights` are packed by pack_own_share.
OwnShare add_own_share(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& frame, gpu::ImageId merged,
                       gpu::ImageId error, gpu::ImageId weights);

/// The layers' weights as shaders/smooth/own_share.comp reads them.
std::vector<float> pack_own_share(const OwnShareWeights& layers);

}  // namespace becalm::filter
