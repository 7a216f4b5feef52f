#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "frame/image.h"

namespace becalm::filter {

/// Factors, 1 or more, of the radiance of a denoised image's pixels. They return to a matte the light that
/// filtering spread from it into `empty` pixels, where it is discarded. The luminance of each empty pixel
/// goes to the pixels with alpha at most 3 away, in proportion to theirs; where there are none, it is
/// discarded. A pixel gains no more than makes it as bright as the brightest of the 3x3 pixels around it in
/// `beauty`, the image as it came.
///
/// Both images are RGBA and finite, but `beauty` where no factor is used. If no light is returned, the result
/// is empty.
std::vector<float> spilled_light(const Image& beauty, std::span<const std::uint8_t> empty,
                                 const Image& denoised);

}  // namespace becalm::filter
