#pragma once

#include <deque>
#include <string>

#include "app/adaptive_sampling.h"

namespace becalm::app {

/// What became of --noise-target: the noise that is expected in the frames, the samples that they took, and
/// where it is above the target, why. `sampling` is of each eye.
std::string noise_text(double noise, double target, const std::deque<AdaptiveSampling>& sampling);

}  // namespace becalm::app
