#pragma once

#include "frame/image.h"

namespace becalm::io {

/// The light whose product with the surface's colour is `product`; 0 where the colour is 0. What leaks from
/// bright surfaces to dark ones would be divided by next to nothing. So no channel is farther from 0 than the
/// farthest finite light that came, `came` over the colour, in the pixel's block of 16x16 and the eight
/// around; there the sum of the layers is not the beauty. The result is infinite only where `came` is
/// not finite. All images have one shape.
Image light_without_colour(const Image& product, const Image& colour, const Image& came);

}  // namespace becalm::io
