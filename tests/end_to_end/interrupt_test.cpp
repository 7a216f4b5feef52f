// What is left when becalm is stopped in the middle.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

/// What a command with `--progress json` tells as soon as it works on a frame.
constexpr const char* kAtWork = R"("event":"progress")";

class Interrupt : public testing::Test {
 protected:
  std::vector<std::string> render(const std::string& pattern, const std::string& frames,
                                  const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"render", scene_, "-o", folder_ / pattern, "--frames", frames};
    if (!has_option(more, "--spp")) arguments.insert(arguments.end(), {"--spp", "16"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  /// Runs until at least `count` frames are there, then sends the signal.
  Outcome stop_after(const std::vector<std::string>& arguments, const std::string& pattern, int count,
                     int signal) {
    Process process(arguments);
    EXPECT_TRUE(wait_until([&] { return fs::exists(frame_path(folder_ / pattern, count)); }));
    process.signal(signal);
    return process.wait();
  }
  /// Every EXR file can be read to its end; tells how many there are.
  int count_whole(const fs::path& folder) const {
    int count = 0;
    for (const std::string& name : files_in(folder)) {
      if (fs::path(name).extension() != ".exr") continue;
      EXPECT_NO_THROW(io::read_exr((folder / name).string(), 0, {})) << name;
      ++count;
    }
    return count;
  }

  TempFolder folder_;
  std::string scene_ = write_scene(folder_);
  /// Frames that take an hour, to be stopped at work.
  std::vector<std::string> long_frames_{"--spp", "65536", "--size", "640x480", "--progress", "json"};
};

TEST_F(Interrupt, AKilledRenderLeavesWholeFilesAndResumes) {
  const Outcome killed = stop_after(render("out/a.####.exr", "1-400"), "out/a.####.exr", 3, SIGKILL);
  EXPECT_EQ(killed.status, 128 + SIGKILL);
  const int count = count_whole(folder_.path() / "out");
  EXPECT_GE(count, 3);
  EXPECT_LT(count, 400);
  becalm_done(render("out/a.####.exr", "1-5", {"--resume", "--quiet"}));
  becalm_done(render("whole.####.exr", "1-5", {"--quiet"}));
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "out/a.####.exr", 1, 5);
}

TEST_F(Interrupt, AKilledDenoiseLeavesWholeFiles) {
  becalm_done(render("in.####.exr", "1-60", {"--spp", "1", "--quiet"}));
  const Outcome killed = stop_after({"denoise", folder_ / "in.####.exr", "-o", folder_ / "out/a.####.exr"},
                                    "out/a.####.exr", 2, SIGKILL);
  EXPECT_EQ(killed.status, 128 + SIGKILL);
  const int count = count_whole(folder_.path() / "out");
  EXPECT_GE(count, 2);
  EXPECT_LT(count, 60);
}

TEST_F(Interrupt, StalePartialFilesAreCleanedAndOthersAreNot) {
  // No process can have this number: it is beyond the kernel's largest.
  const std::string stale = folder_ / "out/a.0002.exr.partial.99999999.0";
  const std::string at_work = folder_ / fmt::format("out/a.0002.exr.partial.{}.0", getpid());
  const std::string of_others = folder_ / "out/b.0002.exr.partial.99999999.0";
  for (const std::string& path : {stale, at_work, of_others}) write_text(path, "half a file");
  becalm_done(render("out/a.####.exr", "1-2", {"--spp", "1", "--quiet"}));
  EXPECT_FALSE(fs::exists(stale));
  EXPECT_TRUE(fs::exists(at_work)) << "its process runs";
  EXPECT_TRUE(fs::exists(of_others)) << "not a frame of this run";
}

TEST_F(Interrupt, SignalsEndARenderWithOneLineAndResumeGoesOn) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const std::string pattern = fmt::format("signal{}/a.####.exr", signal);
    const Outcome outcome = stop_after(render(pattern, "1-400", {"--quiet"}), pattern, 2, signal);
    EXPECT_EQ(outcome.status, signal == SIGHUP ? 129 : 130);
    const int count = count_whole((folder_.path() / pattern).parent_path());
    EXPECT_EQ(outcome.err,
              fmt::format("interrupted: {} of 400 frames written; go on with --resume\n", count));
    becalm_done(render(pattern, "1-4", {"--resume", "--quiet"}));
    if (signal == SIGINT) becalm_done(render("whole.####.exr", "1-4", {"--quiet"}));
    expect_same_beauty(folder_ / "whole.####.exr", folder_ / pattern, 1, 4);
    for (const std::string& name : files_in((folder_.path() / pattern).parent_path())) {
      EXPECT_EQ(name.find("partial"), std::string::npos) << name;
    }
  }
}

TEST_F(Interrupt, ASecondHangUpLeavesNoLockAndNohupIsKeptTo) {
  const std::vector<std::string> arguments = render("out/a.####.exr", "1-2", long_frames_);
  {
    Process process(arguments);
    ASSERT_TRUE(process.wait_for(kAtWork));
    for (int count = 0; count < 2; ++count) process.signal(SIGHUP);
    EXPECT_EQ(process.wait().status, 129);
    EXPECT_FALSE(fs::exists(folder_ / "out/.becalm.lock"));
  }
  Process process(arguments, "trap '' HUP; exec \"$0\" \"$@\"");
  ASSERT_TRUE(process.wait_for(kAtWork));
  process.signal(SIGHUP);
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait().status, 130) << "SIGHUP was not ignored";
}

TEST_F(Interrupt, TwoWritersOfOneFrameAreToldApart) {
  Process first(render("out/a.####.exr", "1-3", long_frames_));
  ASSERT_TRUE(first.wait_for(kAtWork));
  expect_error(becalm(render("out/a.%04d.exr", "3-4", {"--spp", "1"})), 4,
               {"out/a.0003.exr: another becalm is about to write it"});
  becalm_done(render("out/a.####.exr", "7-8", {"--spp", "1", "--quiet"}));
  becalm_done(render("out/b.####.exr", "1-2", {"--spp", "1", "--quiet"}));
  first.signal(SIGINT);
  EXPECT_EQ(first.wait().status, 130);
  becalm_done(render("out/a.####.exr", "1-2", {"--spp", "1", "--quiet"}));
  EXPECT_FALSE(fs::exists(folder_ / "out/.becalm.lock"));
}

TEST_F(Interrupt, ALongFrameIsGivenUpAtOnce) {
  Process process(render("out/a.####.exr", "1-2", long_frames_));
  ASSERT_TRUE(process.wait_for(kAtWork));
  process.signal(SIGINT);
  const Outcome outcome = process.wait();
  EXPECT_EQ(outcome.status, 130);
  EXPECT_NE(outcome.err.find("interrupted: 0 of 2 frames written; go on with --resume"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(files_in(folder_ / "out"), std::vector<std::string>{});
}

TEST_F(Interrupt, AnInterruptedDenoiseResumesToTheSamePixels) {
  becalm_done(render("in.####.exr", "1-60", {"--spp", "1", "--quiet"}));
  const auto denoise = [&](const std::string& pattern, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"denoise", folder_ / "in.####.exr", "-o", folder_ / pattern,
                                       "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  const Outcome outcome = stop_after(denoise("a.####.exr", {}), "a.####.exr", 2, SIGINT);
  EXPECT_EQ(outcome.status, 130);
  EXPECT_NE(outcome.err.find("of 60 frames written; go on with --resume"), std::string::npos) << outcome.err;
  becalm_done(denoise("a.####.exr", {"--resume"}));
  becalm_done(denoise("whole.####.exr", {}));
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "a.####.exr", 1, 60);
}

TEST_F(Interrupt, AnInterruptedRenderAndDenoiseResumesToTheSamePixels) {
  const std::vector<std::string> options{"--denoise", "--quiet", "--spp", "4"};
  const Outcome outcome = stop_after(render("a.####.exr", "1-40", options), "a.####.exr", 2, SIGINT);
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  std::vector<std::string> resumed = options;
  resumed.emplace_back("--resume");
  becalm_done(render("a.####.exr", "1-40", resumed));
  becalm_done(render("whole.####.exr", "1-40", options));
  expect_same_beauty(folder_ / "whole.####.exr", folder_ / "a.####.exr", 1, 40);
}

}  // namespace
}  // namespace becalm::test
