// The order of steps, and its independence of how a sequence is cut into jobs.
#include "filter/sequence/schedule.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <string>

namespace becalm::filter {
namespace {

std::vector<int> range(int first, int last) {
  std::vector<int> frames(static_cast<std::size_t>(last - first + 1));
  std::iota(frames.begin(), frames.end(), first);
  return frames;
}

std::set<int> set_of(int first, int last) {
  const std::vector<int> frames = range(first, last);
  return {frames.begin(), frames.end()};
}

/// `<5* <4 |3 >4`: backward 5 and 4, forward 3 and 4; `*` wanted, `|` a new history.
std::string text(const Segment& segment) {
  std::string result;
  for (const Step& step : segment) {
    if (!result.empty()) result += ' ';
    if (step.new_history) result += '|';
    result += step.direction == Direction::forward ? '>' : '<';
    result += std::to_string(step.frame);
    if (step.wanted) result += '*';
  }
  return result;
}

TEST(Schedule, GoesBackwardThenForwardThroughEachSegment) {
  const auto segments = schedule(range(1, 9), set_of(1, 9), {.segment = 4, .warmup = 1});
  ASSERT_EQ(segments.size(), 3u);
  EXPECT_EQ(text(segments[0]), "|<4 <3* <2* <1* |>1* >2* >3*");
  EXPECT_EQ(text(segments[1]), "|<8 <7* <6* <5* <4* |>3 >4* >5* >6* >7*");
  EXPECT_EQ(text(segments[2]), "|<9* <8* |>7 >8* >9*");
}

TEST(Schedule, SaysWhichFramesComeAgain) {
  std::string again;
  for (const Segment& segment : schedule(range(1, 9), set_of(1, 9), {.segment = 4, .warmup = 1})) {
    for (const Step& step : segment) {
      if (step.again)
        again += (step.direction == Direction::forward ? '>' : '<') + std::to_string(step.frame);
    }
  }
  // Frames around a border of segments are steps of both: 3 and 4, 7 and 8.
  EXPECT_EQ(again, "<4<3<2<1>3<8<7<6<5<4>7<9<8");
}

TEST(Schedule, NegativeNumbersHaveSegmentsToo) {
  const auto segments = schedule(range(-5, 1), set_of(-5, 1), {.segment = 4, .warmup = 0});
  ASSERT_EQ(segments.size(), 3u);
  EXPECT_EQ(text(segments[0]), "|<-5* |>-5*");
  EXPECT_EQ(text(segments[1]), "|<-1* <-2* <-3* <-4* |>-4* >-3* >-2* >-1*");
}

TEST(Schedule, ForwardAloneHasUnboundedHistoryUnlessSegmentsBoundIt) {
  const auto whole = schedule(range(1, 5), {3, 4}, {.directions = Directions::forward});
  ASSERT_EQ(whole.size(), 1u);
  EXPECT_EQ(text(whole[0]), "|>1 >2 >3* >4*");
  const auto bounded =
      schedule(range(1, 5), {3, 4}, {.directions = Directions::forward, .segment = 4, .warmup = 1});
  ASSERT_EQ(bounded.size(), 2u);
  EXPECT_EQ(text(bounded[0]), "|>1 >2 >3*");
  EXPECT_EQ(text(bounded[1]), "|>3 >4*");
}

/// The steps of the segment that contribute to a frame's output. They must not depend on which other frames
/// are wanted.
std::string made_from(const Segment& segment, int frame) {
  std::string result;
  std::string history;
  for (const Step& step : segment) {
    if (step.new_history) history.clear();
    history += (step.direction == Direction::forward ? '>' : '<') + std::to_string(step.frame);
    if (step.frame == frame && step.wanted) result += history + ' ';
  }
  return result;
}

TEST(Schedule, WhatAFrameIsMadeFromDoesNotDependOnWhatElseIsWanted) {
  std::vector<int> present = range(1, 40);
  std::erase_if(present, [](int frame) { return frame == 13 || frame == 14; });
  const ScheduleOptions options{.segment = 8, .warmup = 3, .cuts = {5, 20, 21}};
  const std::set<int> all(present.begin(), present.end());
  std::map<int, std::string> whole;
  for (const Segment& segment : schedule(present, all, options)) {
    for (const Step& step : segment) {
      if (step.wanted) whole[step.frame] = made_from(segment, step.frame);
    }
  }
  ASSERT_EQ(whole.size(), present.size());
  EXPECT_EQ(whole[12], "<12 >5>6>7>8>9>10>11>12 ");
  EXPECT_EQ(whole[20], "<20 >20 ");
  for (const auto& [first, last] : {std::pair{1, 7}, {8, 15}, {16, 40}, {6, 6}, {20, 23}}) {
    std::set<int> wanted;
    for (const int frame : present) {
      if (frame >= first && frame <= last) wanted.insert(frame);
    }
    std::set<int> came_out;
    for (const Segment& segment : schedule(present, wanted, options)) {
      for (const Step& step : segment) {
        if (!step.wanted) continue;
        EXPECT_EQ(made_from(segment, step.frame), whole[step.frame]) << first << "-" << last;
        if (step.direction == Direction::forward) came_out.insert(step.frame);
      }
    }
    EXPECT_EQ(came_out, wanted);
  }
}

TEST(Schedule, StartsAnewAtGapsAndCutsInBothDirections) {
  const std::vector<int> present{1, 2, 5, 6, 7};
  const std::set<int> wanted(present.begin(), present.end());
  const auto segments = schedule(present, wanted, {.segment = 32, .warmup = 8, .cuts = {7}});
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_EQ(text(segments[0]), "|<7* |<6* <5* |<2* <1* |>1* >2* |>5* >6* |>7*");
  const auto on_twos =
      schedule(std::vector<int>{1, 3, 5}, {1, 3, 5}, {.segment = 32, .warmup = 8, .step = 2});
  EXPECT_EQ(text(on_twos.at(0)), "|<5* <3* <1* |>1* >3* >5*");
}

TEST(Schedule, OneMissingFrameIsAGap) {
  const std::vector<int> present{1, 2, 4, 5};
  const auto segments = schedule(present, {1, 2, 4, 5}, {.segment = 32, .warmup = 8});
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_EQ(text(segments[0]), "|<5* <4* |<2* <1* |>1* >2* |>4* >5*");
}

TEST(Schedule, LeavesOutWhatNothingWantedDependsOn) {
  const auto segments = schedule(range(0, 31), {16}, {.segment = 32, .warmup = 8, .cuts = {10, 20}});
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_EQ(text(segments[0]), "|<19 <18 <17 <16* |>10 >11 >12 >13 >14 >15 >16*");
}

TEST(Schedule, LeavesOutShotsBetweenWantedFrames) {
  const auto segments = schedule(range(1, 12), {2, 11}, {.segment = 32, .warmup = 8, .cuts = {5, 9}});
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_EQ(text(segments[0]), "|<12 <11* |<4 <3 <2* |>1 >2* |>9 >10 >11*");
}

}  // namespace
}  // namespace becalm::filter
