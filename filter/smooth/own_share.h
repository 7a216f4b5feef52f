#pragma once

#include <optional>
#include <vector>

#include "filter/gpu/chain.h"
#include "filter/input/noisy_inputs.h"
#include "filter/smooth/weights.h"

namespace becalm::filter {

struct OwnShare {
  gpu::ImageId share;  ///< f32: share of the frame itself in the output
  gpu::ImageId stats;  ///< f32x2: (squared error that is then expected; the estimate's second value)
};

/// An estimate of the frame that was smoothed: a merged frame, or a merge of smoothed frames.
struct SmoothEstimate {
  gpu::ImageId color;
  /// f32x2: (expected squared error; number of frames that NoisyInputs::variance is to be divided by, 0 for a
  /// pixel that is not finite).
  gpu::ImageId stats;
  /// f32x2; the second is the mean relative variance of the patch around (smooth/share), if known.
  std::optional<gpu::ImageId> detail;
  std::optional<gpu::ImageId> fade;  ///< f32, 1x1, in [0,1]: shares are multiplied by it
};

/// How much of the frame itself the output takes. Merging and smoothing blur detail that the frame has.
/// Where the frame is mostly noise, its share is small. Trained layers tell the share from the error that the
/// network expects, the noise of what was merged and the difference of frame and estimate. `weights` are
/// packed by pack_own_share.
OwnShare add_own_share(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& frame,
                       const SmoothEstimate& estimate, gpu::ImageId weights);

/// The layers' weights as shaders/smooth/own_share.comp reads them.
std::vector<float> pack_own_share(const OwnShareWeights& layers);

}  // namespace becalm::filter
