#pragma once

#include "filter/gpu/chain.h"
#include "filter/input/noisy_inputs.h"

namespace becalm::filter {

/// The share of the unmerged frame in the result, f32, and the result's statistics, f32x2.
struct OwnShare {
  gpu::ImageId share;
  gpu::ImageId stats;
};

/// How much of the unmerged frame the result takes. That is much where merging and smoothing blurred detail
/// and the frame has little noise. `color` is the smoothed merged frame with (remaining variance, valid) in
/// `stats`; `expected` is the squared error that the network expects, f32x2 as `stats`.
OwnShare add_own_share(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& frame, gpu::ImageId color,
                       gpu::ImageId stats, gpu::ImageId expected);

}  // namespace becalm::filter
