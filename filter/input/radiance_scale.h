#pragma once

#include <optional>

#include "frame/frame.h"

namespace becalm::filter {

/// The power of two that brings the frame's typical luminance nearer to 1, if that is so far from 1 that
/// squares of radiance would leave the range of floats; else 1. The present one of the frame before, if there
/// is one, as long as it will do, and for a black frame. The filter is exactly invariant to it.
std::optional<float> radiance_scale(const Frame& frame, std::optional<float> present);

/// Multiplies radiance by a power of two, and variances by its square, in all AOVs that are either. What
/// would leave the range of floats becomes its largest value; NaN and Inf stay.
void scale_radiance(Frame& frame, float scale);

}  // namespace becalm::filter
