#pragma once

#include <array>

#include "frame/frame.h"

namespace becalm::filter {

/// Where an eye's pixels are in the other eye's image.
struct Correspondence {
  Image offset;  ///< two channels, in pixels; kNowhere (shaders/shared/limits.h) where not known
  Image depth;   ///< one channel: the depth that is expected there, 0 where not known; empty without depth
};

/// By the depth of a frame whose stereo camera is known. Offsets are along x; longer ones than `limit_px` are
/// not known.
Correspondence correspondence_by_depth(const Frame& frame, float limit_px);

/// Offsets of each image into the other (two channels, px) from a search of the first alone, whose results
/// are `offsets` and the patch distances `residual`, of one size. Of pixels that lead to the same one, those
/// stay whose offset is within 1 px of the best one's, which has the least residual. A pixel of the second
/// image gets the negated offset of the best pixel that leads to it or beside it. Other pixels, which only
/// one eye sees, get kNowhere. Di Stefano, Marchionni, Mattoccia, "A fast area-based stereo matching
/// algorithm" (2004).
std::array<Image, 2> unique_offsets(const Image& offsets, const Image& residual);

}  // namespace becalm::filter
