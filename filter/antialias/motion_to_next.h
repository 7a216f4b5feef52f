#pragma once

#include "frame/frame.h"

namespace becalm::filter {

/// The motion from a frame to the next one, in the layout of the motion AOV, of the next frame's motion (to
/// this one), depth and jitter, as far as it has them: each sample of the next frame is put where it comes
/// from; of those that fall into one pixel the closest counts. Pixels in which none falls have no motion
/// (NaN).
Image motion_to_next(const Frame& next);

}  // namespace becalm::filter
