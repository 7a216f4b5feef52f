#pragma once

#include <optional>

#include "filter/estimate.h"
#include "frame/image.h"

namespace becalm::filter {

/// The power of two by which an image's colours (RGBA, finite) are scaled: scaling back is exact. It brings
/// the largest, but for fireflies, to 0.5 to 1, or lower if fireflies would be limited else. None for black.
std::optional<float> scale_of(const Image& color);

/// Multiplies colours and limits them to 2^60. Alpha stays as it is.
void scale_colors(Image& color, float scale);

/// Brings an estimate to another scale: its colours as above, variances by the square.
void rescale(Estimate& estimate, float ratio);

}  // namespace becalm::filter
