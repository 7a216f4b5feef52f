// What the command line says of a slip of the keys, and where its help is.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

class CommandLine : public testing::Test {
 protected:
  /// `render` of the scene into a.exr.
  Outcome render(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"render", scene_, "-o", folder_ / "a.exr"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return becalm(arguments);
  }
  void write_frames(int count) const {
    for (int frame = 1; frame <= count; ++frame)
      io::write_exr(frame_path(input_, frame), noise_frame(frame, 8, 8), {});
  }

  TempFolder folder_;
  std::string scene_ = write_scene(folder_);
  std::string input_ = folder_ / "in/s.####.exr";
};

TEST_F(CommandLine, HelpAndVersionAreFoundWhereverTheyAreAskedFor) {
  for (const char* command : {"render", "denoise", "antialias", "burst", "compare", "info", "test"}) {
    const std::string usage = std::string("Usage: becalm ") + command;
    EXPECT_NE(becalm_done({command, "--help-all"}).out.find(usage), std::string::npos) << command;
    EXPECT_EQ(becalm_done({"help", command}).out, becalm_done({command, "--help"}).out);
    EXPECT_EQ(becalm_done({command, "--version"}).out, becalm_done({"--version"}).out);
  }
  expect_error(becalm({"help", "compar"}), kUsage, {"did you mean compare?"});
  EXPECT_EQ(becalm_done({"help"}).out, becalm_done({"--help"}).out);
  EXPECT_EQ(becalm_done({"help", "help"}).out, becalm_done({"--help"}).out);
  EXPECT_NE(becalm_done({"--help-all"}).out.find("Usage: becalm burst "), std::string::npos);
}

TEST_F(CommandLine, ANameThatIsNearIsSuggested) {
  expect_error(becalm({"rendr"}), kUsage, {"did you mean render?"});
  expect_error(render({"--sp", "8"}), kUsage, {"--sp 8 (did you mean --spp?)"});
  expect_error(render({"--adapt"}), kUsage, {"did you mean --adaptive?"});
  expect_error(render({"--farmes=1"}), kUsage, {"did you mean --frames?"});
  expect_error(render({"--denoise", "final"}), kUsage, {"final (did you mean --denoise=final?)"});
  for (const char* unlike : {"--nothing-like-it", "--", "--de"})
    EXPECT_EQ(render({unlike, "x"}).err.find("did you mean"), std::string::npos) << unlike;
  EXPECT_EQ(becalm({""}).err.find("did you mean"), std::string::npos);
}

TEST_F(CommandLine, NumbersAreWholeAndGivenOnce) {
  for (const char* spp : {"8x", "1e3", "0", "-1", "1.5"})
    expect_error(render({"--spp", spp}), kUsage,
                 {"--spp: expected a whole number from 1 to 65536, found ", spp});
  expect_error(render({"--frames", "1", "--frames", "2"}), kUsage, {"--frames: is given 2 times"});
  expect_error(render({"-o", "b.exr"}), kUsage, {"--output: is given 2 times"});
  expect_error(render({"--denoise=draft", "--denoise=final"}), kUsage, {"--denoise: is given 2 times"});
  EXPECT_EQ(render({"--frames", "1", "--spp", "1", "-q", "-q", "--aovs", "albedo, normal"}).status, 0);
  EXPECT_TRUE(read_frame(folder_ / "a.exr", all_aovs()).has(Aov::normal));
}

TEST_F(CommandLine, TheTypeOfColoursHasOneName) {
  for (const char* type : {"half", "float"}) {
    EXPECT_EQ(render({"--frames", "1", "--spp", "1", "-q", "--overwrite", "--type", type}).status, 0);
    EXPECT_NE(io::read_attribute(folder_ / "a.exr", "becalm:settings").find(std::string("color=") + type),
              std::string::npos);
  }
  EXPECT_EQ(render({"--frames", "1", "--spp", "1", "-q", "--overwrite", "--half-float"}).status, 0);
  expect_error(render({"--float", "--type", "half"}), kUsage, {"--float: is --type float"});
}

TEST_F(CommandLine, PatternsThatTheShellExpandedAndFoldersNameTheSequence) {
  write_frames(3);
  const std::string quoted = "'" + input_ + "'";
  const std::vector<std::string> files{frame_path(input_, 1), frame_path(input_, 2), frame_path(input_, 3)};
  expect_error(becalm({"info", files[0], files[1], files[2]}), kUsage, {"one argument in quotes", quoted});
  expect_error(becalm({"denoise", files[0], files[1], "-o", folder_ / "o.####.exr"}), kUsage, {quoted});
  const std::string result = folder_ / "o.####.exr";
  expect_error(becalm({"denoise", files[0], files[1], files[2], "-o", result}), kUsage, {quoted});
  expect_error(becalm({"antialias", files[0], files[1], files[2], "-o", result}), kUsage, {quoted});
  EXPECT_FALSE(fs::exists(frame_path(result, 1)));
  expect_error(becalm({"info", folder_ / "in"}), kUsage, {"a folder; name a sequence in it: ", quoted});
  expect_error(becalm({"denoise", folder_ / "in", "-o", folder_ / "o.####.exr"}), kUsage, {quoted});
  expect_error(becalm({"compare", folder_ / "in", folder_ / "in"}), kUsage, {quoted});
  expect_error(becalm({"burst", folder_ / "in", "-o", folder_ / "o.exr"}), 3, {"not a file"});
}

TEST_F(CommandLine, WhatCannotBeMeantIsRefused) {
  write_frames(1);
  const std::string file = frame_path(input_, 1);
  for (const char* field : {"####", "%04d", "$F4"}) {
    expect_error(becalm({"denoise", input_, "-o", folder_ / field + "/a.exr"}), kUsage,
                 {field, "in a folder's name"});
  }
  for (const char* name : {"100%done", "$FOO", "take#2"})
    becalm_done({"denoise", input_, "-o", folder_ / name + "/a.exr", "--dry-run"});
  fs::create_directories(folder_ / "##");
  becalm_done({"denoise", input_, "-o", folder_ / "##/a.exr", "--dry-run"});
  expect_error(becalm({"render", file, "-o", folder_ / "a.exr"}), 3, {"an EXR file", "becalm denoise"});
  expect_error(becalm({"info", scene_, "--audit"}), kUsage, {"--audit", "is a scene"});
  expect_error(becalm({"info", "device", "--audit"}), kUsage, {"--audit"});
  expect_error(becalm({"burst", file, "-o", folder_ / "a.dng", "--mosaic"}), kUsage, {"--mosaic", "DNG"});
  expect_error(render({"--frames", "1", "--denoise", "--context", "none", "--keep-noisy", folder_ / "a.exr"}),
               kUsage, {"--keep-noisy ", "would overwrite a frame of -o"});
}

TEST_F(CommandLine, InfoDescribesBothEyes) {
  for (const char* eye : {"left", "right"})
    io::write_exr(folder_ / eye + ".0001.exr", noise_frame(1, 8, 8), {});
  const std::string told = becalm_done({"info", folder_ / "%V.####.exr"}).out;
  EXPECT_NE(told.find("left.####.exr: 1 frame"), std::string::npos) << told;
  EXPECT_NE(told.find("right.####.exr: 1 frame"), std::string::npos) << told;
}

TEST_F(CommandLine, AReportOnStandardOutputIsAloneThere) {
  write_frames(2);
  const Outcome piped = becalm_done({"compare", input_, input_, "--json", "-"});
  EXPECT_EQ(nlohmann::json::parse(piped.out).at("frames").size(), 2u);
  EXPECT_NE(piped.err.find("relMSE"), std::string::npos) << "the table";
  const Outcome quiet = becalm_done({"compare", input_, input_, "-q"});
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST_F(CommandLine, CompareNamesTheFramesThatAreThere) {
  write_frames(3);
  fs::create_directories(folder_ / "t");
  for (const int frame : {1, 2}) fs::copy(frame_path(input_, frame), folder_ / "t");
  expect_error(becalm({"compare", input_, folder_ / "t/s.####.exr"}), 3, {"--frames 1,2 compares"});
}

}  // namespace
}  // namespace becalm::test
