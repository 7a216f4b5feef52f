#pragma once

#include "filter/gpu/chain.h"
#include "filter/input/noisy_inputs.h"

namespace becalm::filter {

/// The share of the unmerged frame in the result, f32, and the result's statistics, f32x2.
struct OwnShare {
  gpu::ImageId share;
  gpu::ImageId stats;
};

/// Of a merged frame and its smoothed result, `color` with (remaining variance, valid) in `stats`: how much
/// of the frame itself the result takes. `expected` is the error that the network expects, f32x2 as `stats`.
/// It is much where merging and smoothing blurred more than noise would have done: detail in frames of little
/// noise.
OwnShare add_own_share(gpu::Chain& chain, gpu::Extent full, const NoisyInputs& frame, gpu::ImageId color,
                       gpu::ImageId stats, gpu::ImageId expected);

}  // namespace becalm::filter
