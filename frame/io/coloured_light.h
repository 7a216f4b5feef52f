#pragma once

#include "frame/image.h"

namespace becalm::io {

/// The light whose product with the surface's colour is `product`, the filter's result; 0 where the colour is
/// 0. `came` is the product before filtering. What the filter spreads from bright surfaces to nearly black
/// ones would become huge by the division, so each channel's magnitude is limited to the largest finite one
/// of `came` / colour in the pixel's block of 16x16 and the eight around it. Where it is limited, the layers
/// do not add up to the beauty. Infinite only where `came` is not finite. All images have one shape.
Image light_without_colour(const Image& product, const Image& colour, const Image& came);

}  // namespace becalm::io
