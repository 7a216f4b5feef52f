#pragma once

#include <optional>

#include "filter/estimate.h"
#include "frame/image.h"

namespace becalm::filter {

/// The power of two, from 2^-120 to 2^120, by which an image's colours (RGBA, finite) are scaled; scaling
/// back is exact. It brings the largest usual magnitude (Exponents::largest_usual) to [0.5, 1), or lower,
/// down to 2^-40, as far as the limit of scale_colors would otherwise cut fireflies. Nothing for a black
/// image.
std::optional<float> scale_of(const Image& color);

/// Multiplies colours and limits them to 2^60. Alpha stays as it is.
void scale_colors(Image& color, float scale);

/// Brings an estimate to another scale: its colours as above, variances by the square.
void rescale(Estimate& estimate, float ratio);

}  // namespace becalm::filter
