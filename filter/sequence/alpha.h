#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "frame/image.h"

namespace becalm::filter {

/// 1 for each pixel of an RGBA image whose alpha looks noisy, as under motion blur and depth of field at few
/// samples. A pixel is rough if in each of the four directions through it alpha rises to both sides or falls
/// to both sides. It is noisy if its alpha differs from a neighbour's and, of the 15x15 pixels around it, at
/// least 6, and at least a twentieth of those that differ from a neighbour, are rough. Edges and gradients
/// have fewer rough pixels; clean hair and foliage may have as many, so the filter uses this test only on
/// request. Steps of alpha up to 1/64 are ignored.
std::vector<std::uint8_t> noisy_alpha(const Image& beauty);

/// 1 for each empty pixel of an RGBA image: colour and alpha are 0, so is the colour of every transparent
/// pixel near it, and none near it is among the `noisy` ones, whose alpha is denoised: at few samples some
/// pixels of a blurred edge happen to get none of the object. If alpha is 0 everywhere, the image has no
/// matte and no pixel is empty.
std::vector<std::uint8_t> empty_pixels(const Image& beauty, std::span<const std::uint8_t> noisy);

/// Copies the alpha of `beauty` to `denoised`, except where `noisy` is 1: there `denoised` keeps its own,
/// clamped to [0,1].
void pass_on_alpha(const Image& beauty, std::span<const std::uint8_t> noisy, Image& denoised);

}  // namespace becalm::filter
