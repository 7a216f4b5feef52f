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

/// Offsets of both images (two channels) from a search of the first alone, `residual` its patch distances, of
/// the same size: where several pixels lead to one, those of the surface with the least residual are kept,
/// and the other image's offsets lead back. kNowhere elsewhere: what one eye alone sees is found nowhere in
/// the other. Di Stefano, Marchionni, Mattoccia, "A fast area-based stereo matching algorithm" (2004).
std::array<Image, 2> unique_offsets(const Image& offsets, const Image& residual);

}  // namespace becalm::filter
