#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "frame/image.h"

namespace becalm::filter {

/// 1 for each pixel of an RGBA image whose alpha looks noisy, as motion blur and depth of field make it at
/// few samples: alpha that differs from a neighbour's, in a window in which it goes up and down in all
/// directions at too many pixels for an edge or a gradient. Clean hair and foliage look alike, so nothing is
/// altered by this test alone. Alpha of 0 and 1 with equal neighbours is never noisy, and neither are steps
/// below 1/64.
std::vector<std::uint8_t> noisy_alpha(const Image& beauty);

/// 1 for each pixel of an RGBA image that shows nothing: colour and alpha are 0, and so is the colour of
/// every pixel around it whose alpha is 0. None where alpha is 0 everywhere: its writer has no matte.
std::vector<std::uint8_t> empty_pixels(const Image& beauty);

/// Gives `denoised` the alpha of `beauty`, except where `noisy` is 1: there its own, brought into
/// [0,1].
void pass_on_alpha(const Image& beauty, std::span<const std::uint8_t> noisy, Image& denoised);

}  // namespace becalm::filter
