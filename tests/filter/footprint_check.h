#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "filter/gpu/chain.h"

namespace becalm {

/// The sizes of a chain's tile in pixels of the frame, which are multiples of every image's pixel.
struct TileSizes {
  int target;
  int origin = 0;        ///< from the source rectangle's edge to the target's
  int offset_limit = 0;  ///< largest component of the motion and of the offsets at which the history is read
};

/// Compares the footprints that a pass declares with what it reads. Runs the pass alone on random images,
/// then again with single pixels of one image changed: pixels that the pass writes may only change if their
/// footprints contain a changed pixel, and on each side of a footprint a pixel at its edge must change some.
/// Returns a sentence for each contradiction. Images are square.
std::vector<std::string> wrong_footprints(const gpu::Chain& chain, std::size_t pass, const TileSizes& sizes);

}  // namespace becalm
