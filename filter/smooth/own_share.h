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

/// The smoothed merged frame.
struct SmoothedMerged {
  gpu::ImageId color;
  gpu::ImageId stats;  ///< as OwnShare::stats
  /// f32x2; the second is the mean relative variance of the patch around (smooth/share).
  gpu::ImageId detail;
};

/// How much of the frame itself the output takes. Merging and smoothing blur detail that the frame has.
/// Where the frame is mostly noise, its share is small. Trained layers tell the share from the error that the
/// network expects, the noise of the merged frame and the difference of both. `weights` are packed by
/// pack_own_share.
OwnShare add_own_share(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& frame,
                       const SmoothedMerged& merged, gpu::ImageId weights);

/// The layers' weights as shaders/smooth/own_share.comp reads them.
std::vector<float> pack_own_share(const OwnShareWeights& layers);

}  // namespace becalm::filter
