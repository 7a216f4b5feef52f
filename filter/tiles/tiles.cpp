#include "filter/tiles/tiles.h"

#include <fmt/format.h>

#include <algorithm>

#include "filter/ceil_div.h"

namespace becalm::filter {
namespace {

using gpu::Extent;

struct Span {
  int begin = 0;
  int size = 0;
};

/// A tile along one axis.
struct TileSpan {
  Span core;
  Span target;
  Span source;
};

/// TileRules along one axis.
struct SpanRules {
  int grid;
  int core_grid;
  int before;
  int after;
  int reach;
};

SpanRules along_x(const TileRules& rules) {
  return {rules.grid, rules.core_grid, rules.margin.left, rules.margin.right, rules.reach};
}

SpanRules along_y(const TileRules& rules) {
  return {rules.grid, rules.core_grid, rules.margin.above, rules.margin.below, rules.reach};
}

int round_down(int value, int multiple) {
  return value / multiple * multiple;
}

int round_up(int value, int multiple) {
  return ceil_div(value, multiple) * multiple;
}

std::vector<TileSpan> cut(int frame, int target, const SpanRules& rules) {
  if (target == frame) return {{{0, frame}, {0, frame}, {0, frame}}};
  const int reach = round_up(rules.reach, rules.grid);
  const int source = std::min(target + 2 * reach, frame);
  std::vector<TileSpan> tiles;
  for (int core = 0; core < frame;) {
    const int begin = std::min(round_down(std::max(core - rules.before, 0), rules.grid), frame - target);
    const int end = begin + target;
    const int core_end = end == frame ? frame : round_down(end - rules.after, rules.core_grid);
    if (end < frame && core_end < core + rules.grid) return {};
    tiles.push_back({.core = {core, core_end - core},
                     .target = {begin, target},
                     .source = {std::clamp(begin - reach, 0, frame - source), source}});
    core = core_end;
  }
  return tiles;
}

/// Candidate sizes of target rectangles in descending order: the smallest size for each number of tiles.
std::vector<int> useful_sizes(int frame, const SpanRules& rules) {
  std::vector<int> sizes;
  std::size_t count = 0;
  for (int size = frame; size > 0; size -= rules.grid) {
    const std::size_t needed = cut(frame, size, rules).size();
    if (needed == 0) break;
    if (needed == count) {
      sizes.back() = size;
    } else {
      sizes.push_back(size);
      count = needed;
    }
  }
  return sizes;
}

Rect rect(const Span& x, const Span& y) {
  return {x.begin, y.begin, x.size, y.size};
}

/// The largest distance from the inner rectangle's sides to those of the outer one.
int largest_margin(const Rect& inner, const Rect& outer) {
  return std::max({inner.x - outer.x, inner.y - outer.y, outer.x + outer.width - inner.x - inner.width,
                   outer.y + outer.height - inner.y - inner.height});
}

std::string too_large(const char* what, Extent extent, std::uint64_t bytes, std::uint64_t allowed) {
  constexpr double mib = 1024.0 * 1024.0;
  return fmt::format(
      "{} of {}x{} px take {:.2f} MiB of device memory, more than the {:.2f} MiB that are left for them",
      what, extent.width, extent.height, static_cast<double>(bytes) / mib,
      static_cast<double>(allowed) / mib);
}

}  // namespace

Tile uncut(Extent frame) {
  return {bounds(frame), bounds(frame), bounds(frame)};
}

std::vector<Tile> cut_tiles(Extent frame, Extent target, const TileRules& rules) {
  std::vector<Tile> tiles;
  const std::vector<TileSpan> columns = cut(frame.width, target.width, along_x(rules));
  for (const TileSpan& y : cut(frame.height, target.height, along_y(rules))) {
    for (const TileSpan& x : columns) {
      tiles.push_back({rect(x.core, y.core), rect(x.target, y.target), rect(x.source, y.source)});
    }
  }
  return tiles;
}

std::string describe(const std::vector<Tile>& tiles) {
  if (tiles.size() == 1) return "1";
  const auto columns = std::ranges::count_if(tiles, [](const Tile& tile) { return tile.core.y == 0; });
  const auto rows = std::ranges::count_if(tiles, [](const Tile& tile) { return tile.core.x == 0; });
  int margin = 0;
  int reach = 0;
  for (const Tile& tile : tiles) {
    margin = std::max(margin, largest_margin(tile.core, tile.target));
    reach = std::max(reach, largest_margin(tile.target, tile.source));
  }
  const Extent target = tiles.front().target.extent();
  return fmt::format("{}x{} of {}x{} px with margins of up to {} px{}", columns, rows, target.width,
                     target.height, margin,
                     reach > 0 ? fmt::format(", history up to {} px beyond", reach) : "");
}

std::string tiles_too_large(const Tile& tile, std::uint64_t bytes, std::uint64_t allowed) {
  return "even " + too_large("tiles", tile.target.extent(), bytes, allowed);
}

std::string frame_too_large(Extent frame, std::uint64_t bytes, std::uint64_t allowed) {
  return too_large("whole frames", frame, bytes, allowed);
}

gpu::DeviceLimitError cannot_be_cut(Extent frame, const std::string& reason) {
  return gpu::DeviceLimitError(
      fmt::format("frames of {}x{} px cannot be cut small enough: {}", frame.width, frame.height, reason));
}

std::vector<Tile> plan_tiles(Extent frame, const TileRules& rules,
                             const std::function<bool(const Tile&)>& fits) {
  const std::vector<int> widths = useful_sizes(frame.width, along_x(rules));
  const std::vector<int> heights = useful_sizes(frame.height, along_y(rules));
  auto width = widths.begin();
  auto height = heights.begin();
  while (true) {
    std::vector<Tile> tiles = cut_tiles(frame, {*width, *height}, rules);
    if (fits(tiles.front())) return tiles;
    const bool narrower = width + 1 != widths.end();
    const bool lower = height + 1 != heights.end();
    if (!narrower && !lower) return {};
    ++(narrower && (*width >= *height || !lower) ? width : height);
  }
}

}  // namespace becalm::filter
