#include "filter/tiles/tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "filter/align/pyramid.h"
#include "filter/merge/merge_chains.h"
#include "filter/tiles/build_within.h"
#include "tests/filter/device_fixture.h"

namespace becalm::filter {
namespace {

using gpu::Extent;

constexpr TileRules kRules{
    .grid = 64, .core_grid = 4, .margin = {.left = 30, .above = 80, .right = 35, .below = 35}, .reach = 100};

bool covers(const Rect& outer, const Rect& inner) {
  return outer.x <= inner.x && outer.y <= inner.y && outer.x + outer.width >= inner.x + inner.width &&
         outer.y + outer.height >= inner.y + inner.height;
}

/// A rectangle with margins, clipped at the frame's border.
Rect grown(const Rect& rect, const gpu::Margin& margin, Extent frame) {
  const int x = std::max(rect.x - margin.left, 0);
  const int y = std::max(rect.y - margin.above, 0);
  return {x, y, std::min(rect.x + rect.width + margin.right, frame.width) - x,
          std::min(rect.y + rect.height + margin.below, frame.height) - y};
}

void expect_rules_kept(const std::vector<Tile>& tiles, Extent frame, const TileRules& rules) {
  ASSERT_FALSE(tiles.empty());
  std::vector<int> made(frame.elements());
  for (const Tile& tile : tiles) {
    EXPECT_EQ(tile.target.extent(), tiles.front().target.extent());
    EXPECT_EQ(tile.source.extent(), tiles.front().source.extent());
    EXPECT_TRUE(covers(tile.target, grown(tile.core, rules.margin, frame)));
    const gpu::Margin reach{rules.reach, rules.reach, rules.reach, rules.reach};
    EXPECT_TRUE(covers(tile.source, grown(tile.target, reach, frame)));
    EXPECT_TRUE(covers(bounds(frame), tile.source));
    for (const Rect& rect : {tile.target, tile.source}) {
      EXPECT_EQ(rect.x % rules.grid, 0);
      EXPECT_EQ(rect.y % rules.grid, 0);
      EXPECT_EQ((frame.width - rect.width) % rules.grid, 0) << "the last tile must end at the border";
      EXPECT_EQ((frame.height - rect.height) % rules.grid, 0) << "the last tile must end at the border";
    }
    EXPECT_EQ(tile.core.x % rules.core_grid, 0);
    EXPECT_EQ(tile.core.y % rules.core_grid, 0);
    for (int y = tile.core.y; y < tile.core.y + tile.core.height; ++y) {
      for (int x = tile.core.x; x < tile.core.x + tile.core.width; ++x) ++made[y * frame.width + x];
    }
  }
  for (const int times : made) ASSERT_EQ(times, 1);
}

TEST(Tiles, CoverTheFrameOnceAndSeeWhatTheyNeed) {
  const Extent frame{1003, 777};
  for (const Extent target : {Extent{1003, 777}, {619, 777}, {1003, 457}, {235, 265}, {363, 521}}) {
    SCOPED_TRACE(std::to_string(target.width) + "x" + std::to_string(target.height));
    expect_rules_kept(cut_tiles(frame, target, kRules), frame, kRules);
  }
}

TEST(Tiles, OfFramesOfAnySizeSeeWhatTheyNeed) {
  for (int more = 0; more < kRules.grid; more += 3) {
    const Extent frame{384 + more, 512 + more};
    const Extent target{192 + more, 256 + more};
    SCOPED_TRACE(std::to_string(frame.width) + "x" + std::to_string(frame.height));
    expect_rules_kept(cut_tiles(frame, target, kRules), frame, kRules);
  }
}

TEST(Tiles, ThatWouldBeHardlyMoreThanSurroundingsAreNotCut) {
  // 30 px before a core, 35 px after it and up to 63 px more to a multiple of the grid leave less than 64.
  EXPECT_TRUE(cut_tiles({1003, 777}, {107, 777}, kRules).empty());
  EXPECT_TRUE(cut_tiles({1003, 777}, {1003, 73}, kRules).empty());
}

TEST(Tiles, AreAsLargeAsFits) {
  const Extent frame{1003, 777};
  const auto plan = [&](std::uint64_t pixels) {
    return plan_tiles(frame, kRules,
                      [&](const Tile& tile) { return tile.target.extent().elements() <= pixels; });
  };
  EXPECT_EQ(plan(1003 * 777).size(), 1u);
  EXPECT_EQ(plan(1003 * 777 - 1).size(), 2u);
  std::size_t last = 1;
  for (const std::uint64_t pixels : {700'000u, 400'000u, 200'000u, 100'000u}) {
    const std::vector<Tile> tiles = plan(pixels);
    expect_rules_kept(tiles, frame, kRules);
    EXPECT_LE(tiles.front().target.extent().elements(), pixels);
    EXPECT_GE(tiles.size(), last);
    last = tiles.size();
  }
  EXPECT_TRUE(plan(1000).empty());
}

TEST(Tiles, AreDescribed) {
  EXPECT_EQ(describe(cut_tiles({1003, 777}, {1003, 777}, kRules)), "1");
  const std::vector<Tile> tiles = cut_tiles({1003, 777}, {619, 777}, kRules);
  ASSERT_EQ(tiles.size(), 2u);
  EXPECT_EQ(tiles[1].core.x - tiles[1].target.x, 200);
  EXPECT_EQ(tiles[1].target.x - tiles[1].source.x, 256);
  EXPECT_EQ(describe(tiles), "2x1 of 619x777 px with margins of up to 200 px, history up to 256 px beyond");
}

class TilesOfChainsTest : public DeviceTest {};

TEST_F(TilesOfChainsTest, BeginWhereTheSumsOfTheSearchBegin) {
  const FilterTask task{
      .settings = preset("balanced"), .full = {640, 480}, .used = {}, .diagnostics = {}, .guides = {}};
  for (const int factor : {2, 4}) {
    FilterTask with_factor = task;
    Settings& settings = with_factor.settings;
    settings.pyramid.factor = factor;
    for (std::size_t end = 1; end <= 3; ++end) {
      const MergeChain merge(device(), with_factor, {.levels = 5, .coarse = end}, task.full, task.full,
                             /*is_whole_frame=*/false);
      const TileRules rules = merge.chain.tile_rules();
      EXPECT_EQ(rules.grid % rules.core_grid, 0);
      EXPECT_EQ(rules.core_grid, level_px(settings, end));
      EXPECT_EQ(rules.grid % (16 * level_px(settings, end - 1)), 0);
      EXPECT_GT(rules.margin.above, rules.margin.left + (15 - factor) * level_px(settings, end - 1))
          << "runs are right as a whole";
      EXPECT_GT(rules.margin.below, settings.blur_radius.front() * level_px(settings, end - 1));
      EXPECT_EQ(rules.reach, reach_px(settings, 5) + 2) << "the search's and the sharp filter's";
    }
  }
}

TEST_F(TilesOfChainsTest, DoNotDependOnTheSize) {
  FilterTask task{
      .settings = preset("final"), .full = {1920, 1080}, .used = {}, .diagnostics = {}, .guides = {}};
  task.used.set(static_cast<std::size_t>(Aov::motion));
  const auto rules_at = [&](Extent extent) {
    return MergeChain(device(), task, {.levels = 5, .coarse = 2}, extent, extent, /*is_whole_frame=*/false)
        .chain.tile_rules();
  };
  const TileRules rules = rules_at(task.full);
  for (const Extent extent : {Extent{3, 2}, {65, 33}, {100'000, 100'000}}) {
    EXPECT_EQ(rules_at(extent).grid, rules.grid);
    EXPECT_EQ(rules_at(extent).core_grid, rules.core_grid);
    EXPECT_EQ(rules_at(extent).margin, rules.margin);
    EXPECT_EQ(rules_at(extent).reach, rules.reach);
  }
}

/// The limits that `build_within` tries on a device with `free` bytes, for chains that need 1000 at least.
std::vector<std::uint64_t> tried(std::uint64_t limit, std::uint64_t free) {
  std::vector<std::uint64_t> limits;
  build_within(limit, [&](std::uint64_t of_try) {
    limits.push_back(of_try);
    if (of_try < 1000) throw gpu::DeviceLimitError("cannot be cut");
    if (of_try > free) throw gpu::DeviceMemoryError("used up");
  });
  return limits;
}

TEST(BuildWithin, TakesLessWhereMemoryIsMissing) {
  EXPECT_EQ(tried(8000, 9000), std::vector<std::uint64_t>{8000});
  EXPECT_EQ(tried(8000, 3000), (std::vector<std::uint64_t>{8000, 4000, 2000}));
  EXPECT_THROW(tried(8000, 10), gpu::DeviceMemoryError) << "what was missing, not what cannot be cut";
  EXPECT_THROW(tried(500, 10), gpu::DeviceLimitError);
}

}  // namespace
}  // namespace becalm::filter
