#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "frame/image.h"

namespace becalm::filter {

/// 1 for each pixel of an RGBA image whose alpha looks noisy, as under motion blur and depth of field at few
/// samples: alpha differs from a neighbour's, and in the window around it more pixels than at an edge or in a
/// gradient have an alpha that rises or falls to both sides in all directions. Clean hair and foliage pass
/// this test too, so the filter uses it only on request. Alpha that equals all its neighbours is never
/// noisy; steps below 1/64 are ignored.
std::vector<std::uint8_t> noisy_alpha(const Image& beauty);

/// 1 for each empty pixel of an RGBA image: colour and alpha are 0, and so is the colour of every transparent
/// pixel near it. If alpha is 0 everywhere, the image has no matte and no pixel is empty.
std::vector<std::uint8_t> empty_pixels(const Image& beauty);

/// Copies the alpha of `beauty` to `denoised`, except where `noisy` is 1: there `denoised` keeps its own,
/// clamped to [0,1].
void pass_on_alpha(const Image& beauty, std::span<const std::uint8_t> noisy, Image& denoised);

}  // namespace becalm::filter
