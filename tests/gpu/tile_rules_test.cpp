// Rules of tiles from footprints, against arithmetic by hand.
#include "filter/gpu/tile_rules.h"

#include <gtest/gtest.h>

namespace becalm::gpu {
namespace {

using Passes = std::vector<PassFootprints>;

TEST(TileRules, AddUpAlongPasses) {
  const Passes passes{{.reads = {{0, reach(2, 0)}}, .writes = {1}},
                      {.reads = {{1, reach(0, 3)}, {0, reach(1)}}, .writes = {2}}};
  const TileRules rules = tile_rules(passes, std::vector<OutputScale>{{2, 1}});
  EXPECT_EQ(rules.margin, (Margin{.left = 2, .above = 3, .right = 2, .below = 3}));
  EXPECT_EQ(rules.grid, 1);
  EXPECT_EQ(rules.core_grid, 1);
  EXPECT_EQ(rules.reach, 0);
}

TEST(TileRules, IgnoreWhatNoOutputNeeds) {
  const Passes passes{{.reads = {{0, reach(1)}}, .writes = {1}}, {.reads = {{0, reach(9)}}, .writes = {2}}};
  EXPECT_EQ(tile_rules(passes, std::vector<OutputScale>{{1, 1}}).margin, (Margin{1, 1, 1, 1}));
}

TEST(TileRules, FollowScales) {
  // Down by 4, a filter of 5 pixels, and bilinearly up again.
  const Passes passes{{.reads = {{0, block(4, 1)}}, .writes = {1}},
                      {.reads = {{1, reach(2)}}, .writes = {2}},
                      {.reads = {{2, bilinear(4)}, {0, {}}}, .writes = {3}}};
  const TileRules rules = tile_rules(passes, std::vector<OutputScale>{{3, 1}});
  EXPECT_EQ(rules.margin, (Margin{13, 13, 13, 13})) << "one coarse pixel, two coarse pixels, one pixel";
  EXPECT_EQ(rules.core_grid, 4);
  EXPECT_EQ(rules.grid, 4);
}

TEST(TileRules, OfAnOutputOfLargePixelsAreInPixelsOfTheFrame) {
  const Passes passes{{.reads = {{0, block(2)}}, .writes = {1}}, {.reads = {{1, reach(1)}}, .writes = {2}}};
  EXPECT_EQ(tile_rules(passes, std::vector<OutputScale>{{2, 2}}).margin, (Margin{2, 2, 2, 2}));
}

TEST(TileRules, ComputeRunsAsAWhole) {
  const Passes passes{{.reads = {{0, block(2)}}, .writes = {1}},
                      {.reads = {{1, in_runs_of(16, reach(3))}}, .writes = {2}},
                      {.reads = {{2, reach(1)}}, .writes = {3}}};
  const TileRules rules = tile_rules(passes, std::vector<OutputScale>{{3, 2}});
  EXPECT_EQ(rules.margin, (Margin{.left = 8, .above = 38, .right = 8, .below = 8}));
  EXPECT_EQ(rules.grid, 32);
  EXPECT_EQ(rules.core_grid, 2);
}

TEST(TileRules, MeasureGatheredReadsFromTheTarget) {
  // The source is filtered and reduced before it is read at offsets; what the offsets need is the target's.
  const Passes passes{{.reads = {{0, reach(1)}}, .writes = {1}},
                      {.reads = {{1, block(2)}}, .writes = {2}},
                      {.reads = {{2, gather(10)}, {3, reach(4)}}, .writes = {4}},
                      {.reads = {{4, bilinear(2)}, {5, gather(20)}}, .writes = {6}}};
  const TileRules rules = tile_rules(passes, std::vector<OutputScale>{{6, 1}});
  EXPECT_EQ(rules.margin, (Margin{10, 10, 10, 10})) << "five pixels of image 3";
  EXPECT_EQ(rules.reach, 21);
}

TEST(TileRules, HaveRoomForImagesThatAreGathered) {
  // Image 1 depends on the source alone, but a tile has no more of it than its target rectangle.
  const Passes passes{{.reads = {{0, gather(10)}}, .writes = {1}},
                      {.reads = {{1, reach(6)}, {2, reach(4)}}, .writes = {3}}};
  const TileRules rules = tile_rules(passes, std::vector<OutputScale>{{3, 1}});
  EXPECT_EQ(rules.margin, (Margin{6, 6, 6, 6}));
  EXPECT_EQ(rules.reach, 10);
}

TEST(TileRules, LeaveTablesOut) {
  const Passes passes{{.reads = {{0, reach(1)}, {1, anywhere()}}, .writes = {2}}};
  EXPECT_EQ(tile_rules(passes, std::vector<OutputScale>{{2, 1}}).margin, (Margin{1, 1, 1, 1}));
}

TEST(TileRules, RejectContradictions) {
  const auto image_of_error = [](const Passes& passes, int output_px) {
    try {
      static_cast<void>(tile_rules(passes, std::vector<OutputScale>{{2, output_px}}));
    } catch (const FootprintError& error) {
      return error.image;
    }
    return -1;
  };
  EXPECT_EQ(image_of_error({{.reads = {{0, {}}, {0, block(2)}}, .writes = {2}}}, 2), 0) << "two sizes";
  EXPECT_EQ(image_of_error({{.reads = {{0, block(2)}}, .writes = {2}}}, 1), 0) << "smaller than the frame's";
  EXPECT_EQ(
      image_of_error({{.reads = {{0, {}}}, .writes = {1}}, {.reads = {{1, anywhere()}}, .writes = {2}}}, 1),
      1)
      << "a table that is cut";
}

TEST(TileRules, OfTwoChainsKeepBoth) {
  const TileRules rules = rules_for_both({.grid = 32, .core_grid = 2, .margin = {1, 7, 3, 4}, .reach = 5},
                                         {.grid = 12, .core_grid = 3, .margin = {2, 6, 2, 5}, .reach = 9});
  EXPECT_EQ(rules.grid, 96);
  EXPECT_EQ(rules.core_grid, 6);
  EXPECT_EQ(rules.margin, (Margin{2, 7, 3, 5}));
  EXPECT_EQ(rules.reach, 9);
}

}  // namespace
}  // namespace becalm::gpu
