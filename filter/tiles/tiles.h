#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "filter/gpu/device.h"
#include "filter/gpu/image.h"
#include "filter/gpu/tile_rules.h"

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

/// A rectangle relative to the first pixel of `outer`.
constexpr Rect within(const Rect& rect, const Rect& outer) {
  return {rect.x - outer.x, rect.y - outer.y, rect.width, rect.height};
}

/// The part of the frame that one run of the chains computes.
struct Tile {
  Rect core;    ///< pixels it computes; the cores of all tiles cover the frame without overlap
  Rect target;  ///< pixels it reads of the new frame: the core and a margin
  Rect source;  ///< pixels it reads of the history: the target rectangle and a margin
};

/// The single tile of a frame that is not cut.
Tile uncut(gpu::Extent frame);

using gpu::TileRules;

/// Cuts a frame into tiles. All target rectangles have the size `target`, and all source rectangles have one
/// size. Both sizes leave the same remainder modulo the grid as the frame's size, so that the last rectangles
/// end at the frame's border. Empty if `target` leaves no room for cores of at least the grid's size.
std::vector<Tile> cut_tiles(gpu::Extent frame, gpu::Extent target, const TileRules& rules);

/// The plan for people to read: `1`, or `2x3 of 976x560 px with margins of up to 48 px`, followed by how far
/// sources reach beyond the targets if they do. 2x3 are two columns and three rows.
std::string describe(const std::vector<Tile>& tiles);

/// Error texts for tiles that do not fit.
std::string tiles_too_large(const Tile& tile, std::uint64_t bytes, std::uint64_t allowed);
/// The same for what takes whole frames.
std::string frame_too_large(gpu::Extent frame, std::uint64_t bytes, std::uint64_t allowed);
gpu::DeviceLimitError cannot_be_cut(gpu::Extent frame, const std::string& reason);

/// The largest tiles that `fits` accepts; it is given the first tile, whose size all tiles have. Starts with
/// the whole frame and adds one tile at a time along the longer side of the target rectangle. Empty if even
/// the smallest tiles do not fit.
std::vector<Tile> plan_tiles(gpu::Extent frame, const TileRules& rules,
                             const std::function<bool(const Tile&)>& fits);

}  // namespace becalm::filter
