#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "filter/gpu/footprint.h"

namespace becalm::gpu {

/// What a tile needs for the pixels of its core to equal those of the uncut frame, in pixels of the frame. At
/// the frame's border margins are clipped.
struct TileRules {
  int grid = 1;        ///< target and source rectangles begin at multiples of this
  int core_grid = 1;   ///< cores begin at multiples of this; it divides `grid`
  Margin margin = {};  ///< from the core to the edges of the target rectangle
  int reach = 0;       ///< from the target rectangle to the edge of the source rectangle
};

/// A pass, with images as indices.
struct PassFootprints {
  struct Read {
    int image;
    Footprint footprint;
  };
  std::vector<Read> reads;
  std::vector<int> writes;
};

struct OutputScale {
  int image;
  int pixel_px;  ///< side of the image's pixel, in pixels of the frame
};

/// Footprints of an image that contradict each other: its pixels have two sizes or are smaller than the
/// frame's, or it is read anywhere and depends on images that are cut.
struct FootprintError : std::invalid_argument {
  FootprintError(int image, const std::string& what) : std::invalid_argument(what), image(image) {}
  int image;
};

/// Goes through the passes backwards, from the outputs, and finds what is needed of each image. Pure
/// arithmetic, no device types. Throws FootprintError.
TileRules tile_rules(std::span<const PassFootprints> passes, std::span<const OutputScale> outputs);

/// Rules that keep both `a` and `b`.
TileRules rules_for_both(const TileRules& a, const TileRules& b);

}  // namespace becalm::gpu
