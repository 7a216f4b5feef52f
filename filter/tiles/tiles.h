#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "filter/gpu/device.h"
#include "filter/gpu/image.h"

namespace becalm::filter {

/// Pixels [x, x + width) x [y, y + height) of an image.
struct Rect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  gpu::Extent extent() const { return {width, height}; }
  bool contains(int px, int py) const { return px >= x && px < x + width && py >= y && py < y + height; }
  bool operator==(const Rect&) const = default;
};

/// Every pixel of an image.
constexpr Rect bounds(gpu::Extent extent) {
  return {0, 0, extent.width, extent.height};
}

/// A rectangle as seen from the first pixel of another.
constexpr Rect within(const Rect& rect, const Rect& outer) {
  return {rect.x - outer.x, rect.y - outer.y, rect.width, rect.height};
}

/// A part of the frame that one run of the chains makes.
struct Tile {
  Rect core;    ///< what it makes; the cores of all tiles cover the frame without overlap
  Rect target;  ///< what it sees of the new frame: the core and its surroundings
  Rect source;  ///< what it sees of the history: the target's rectangle and its surroundings
};

/// The one tile of a frame that needs no cutting.
Tile uncut(gpu::Extent frame);

/// How much a tile must see around its core, in pixels, for its pixels to come out as those of the whole
/// frame. At the frame's border it sees less, as the whole frame does.
struct TileRules {
  int grid = 1;       ///< rectangles of images begin at multiples of this
  int core_grid = 1;  ///< cores begin at multiples of this; it divides `grid`
  int left = 0;       ///< from the core to the border of the target's rectangle
  int above = 0;
  int after = 0;  ///< to the right and below
  int reach = 0;  ///< from the target's rectangle to the border of the source's
};

/// The rules for what depends on `margin_px` pixels around its own and on no history. Rectangles begin at
/// multiples of `grid_px`, as workgroups do unless more is asked for.
constexpr TileRules local_tile_rules(int margin_px, int grid_px = 8) {
  return {.grid = grid_px, .core_grid = grid_px, .left = margin_px, .above = margin_px, .after = margin_px};
}

/// Cuts a frame into tiles whose target rectangles all have the size `target`, and whose source rectangles
/// have one size, too; both leave the same remainder by the grid as the frame does, so that the last ones end
/// at its border. Empty if `target` leaves no room for cores of at least the grid's size.
std::vector<Tile> cut_tiles(gpu::Extent frame, gpu::Extent target, const TileRules& rules);

/// Why tiles do not fit, in words.
std::string tiles_too_large(const Tile& tile, std::uint64_t bytes, std::uint64_t allowed);
gpu::DeviceLimitError cannot_be_cut(gpu::Extent frame, const std::string& reason);

/// The largest tiles of which `fits` approves, given a first tile that stands for all. Starts with the whole
/// frame and goes on with one tile more along the longer side of the target's rectangle. Empty if not even
/// the smallest fit.
std::vector<Tile> plan_tiles(gpu::Extent frame, const TileRules& rules,
                             const std::function<bool(const Tile&)>& fits);

}  // namespace becalm::filter
