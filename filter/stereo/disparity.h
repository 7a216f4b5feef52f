#pragma once

#include "frame/frame.h"

namespace becalm::filter {

/// Where each pixel of an eye's frame is expected in the other eye's, by its depth. Two channels: the offset
/// along x in pixels (kNoMotion of shaders/lib/motion.glsl where the depth is not known or the offset is
/// longer than `limit_px`, and everywhere without `StereoView`); and the depth there (0 where not known;
/// without `StereoView` the pixel's own).
Image expected_in_other(const Frame& frame, float limit_px);

/// The means of blocks of `scale` x `scale` pixels; blocks at the border are smaller.
Image block_means(const Image& image, int scale);

/// An offset field (two channels) of blocks, read bilinearly at the pixels of a frame of this size, in
/// pixels.
Image upsampled_offsets(const Image& of_blocks, int scale, int width, int height);

}  // namespace becalm::filter
