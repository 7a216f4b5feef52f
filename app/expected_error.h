#pragma once

#include "frame/frame.h"

namespace becalm::app {

/// The squared error that the filter expects of each pixel of its result, relative to the squared brightness:
/// one channel. As in relMSE, 0.01 at usual exposure is added to the square. `exposure` is that of the noisy
/// frame (filter::exposure). Radiance must be of a size whose squares floats hold (filter::radiance_scale).
Image expected_error(const Frame& filtered, float exposure);

/// The mean over the pixels.
double mean_expected_error(const Frame& filtered, float exposure);

}  // namespace becalm::app
