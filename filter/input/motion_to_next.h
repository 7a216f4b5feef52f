#pragma once

#include "frame/frame.h"

namespace becalm::filter {

/// Motion from a frame to the next one, in the layout of the motion AOV, found by inverting the next frame's
/// motion with its depth and jitter, where it has them. Each of its samples goes to the pixel that it came
/// from; of several the closest counts. Pixels that get none have no motion (NaN).
Image motion_to_next(const Frame& next);

}  // namespace becalm::filter
