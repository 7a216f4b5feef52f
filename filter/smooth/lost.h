#pragma once

#include <optional>
#include <string>

#include "filter/gpu/chain.h"
#include "filter/input/noisy_inputs.h"

namespace becalm::filter {

/// Radius of the patches over which differences between a frame and its result are averaged.
inline constexpr int kLostRadius = 3;

/// What a result lost of a frame, and what noise makes of that: f32x4 of smooth/lost, and its patch sums.
struct Lost {
  gpu::ImageId pixels;
  gpu::ImageId sums;
};

/// `color` is the frame that `smoothed` is compared with. If it is one of the frames that were merged,
/// `frames` is their number, since the variance is that of their mean.
Lost add_lost(gpu::Chain& chain, gpu::Extent full, const std::string& name, const NoisyInputs& frame,
              gpu::ImageId color, gpu::ImageId smoothed, std::optional<gpu::ImageId> frames);

}  // namespace becalm::filter
