// becalm info on files and sequences: what it tells, and its exit status.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

constexpr int kBadInput = 3;

class InfoOnSequences : public testing::Test {
 protected:
  void write(int number, const Frame& frame) const { io::write_exr(frame_path(pattern_, number), frame, {}); }
  Frame without_albedo(int number) const {
    Frame frame = noise_frame(number);
    frame.remove(Aov::albedo);
    return frame;
  }

  TempFolder folder_;
  std::string pattern_ = folder_ / "in.####.exr";
};

TEST_F(InfoOnSequences, ASequenceWhoseFramesAreAlikeIsDescribedOnce) {
  for (const int number : {1, 2, 4}) write(number, noise_frame(number));
  const Outcome outcome = becalm_done({"info", pattern_});
  EXPECT_EQ(outcome.out.substr(0, outcome.out.find("\npart")), pattern_ + ": 3 frames, 1,2,4");
  EXPECT_EQ(outcome.out.find("part 0"), outcome.out.rfind("part 0"));
  EXPECT_NE(outcome.out.find("albedo.R"), std::string::npos);
  EXPECT_EQ(outcome.err, "");
}

TEST_F(InfoOnSequences, FramesThatDifferAreToldApart) {
  for (const int number : {2, 3, 4}) write(number, noise_frame(number));
  for (const int number : {1, 5}) write(number, without_albedo(number));
  const Outcome outcome = becalm_done({"info", pattern_});
  EXPECT_NE(outcome.out.find("frames 2-4:\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("frames 1,5 have instead:\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("\n-   albedo.R"), std::string::npos) << outcome.out;
}

TEST_F(InfoOnSequences, WhatCannotBeDenoisedIsDescribedAndIsAnError) {
  Frame depth(1, 8, 8);
  depth.add(Aov::depth, 1.0f);
  write(1, depth);
  write(2, noise_frame(2));
  write_text(frame_path(pattern_, 3), "no image at all");
  const Outcome one = becalm({"info", frame_path(pattern_, 1)});
  EXPECT_EQ(one.status, kBadInput);
  EXPECT_NE(one.out.find("depth.Z"), std::string::npos);
  EXPECT_EQ(one.out.find("no colour"), std::string::npos) << "data alone on standard output";
  EXPECT_NE(one.err.find("becalm: error: " + frame_path(pattern_, 1) + ": no colour"), std::string::npos)
      << one.err;
  const Outcome all = becalm({"info", pattern_});
  EXPECT_EQ(all.status, kBadInput);
  EXPECT_NE(all.err.find("in.0001.exr: no colour"), std::string::npos) << all.err;
  EXPECT_NE(all.err.find("in.0003.exr: not an EXR file"), std::string::npos) << all.err;
  EXPECT_NE(all.err.find("2 of 3 frames cannot be used\n"), std::string::npos) << all.err;
}

TEST_F(InfoOnSequences, FilesOfAnotherPaddingArePointedOut) {
  write(1, noise_frame(1));
  expect_error(becalm({"info", folder_ / "in.##.exr"}), kBadInput, {"in.0001.exr is there", "in.#.exr"});
}

}  // namespace
}  // namespace becalm::test
