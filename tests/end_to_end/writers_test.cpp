// Several runs that write into one folder, and what is in the places of outputs.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "tests/end_to_end/render_fixture.h"

namespace becalm::test {
namespace {

constexpr fs::perms kForEverybody = static_cast<fs::perms>(0666);

/// Whether a process has locked a byte of the file.
bool has_lock(const std::string& path) {
  const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
  struct flock range {};
  range.l_type = F_WRLCK;
  const bool is_known = file >= 0 && fcntl(file, F_OFD_GETLK, &range) == 0;
  if (file >= 0) close(file);
  return is_known && range.l_type != F_UNLCK;
}

class Writers : public Render {
 protected:
  /// Frames that take too long to end by themselves.
  std::vector<std::string> long_render(const std::string& pattern,
                                       const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"--spp", "65536", "--size", "640x480"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return command(pattern, arguments);
  }
  bool appears(const std::string& name) const {
    return wait_until([&] { return fs::exists(folder_ / name); });
  }
};

TEST_F(Writers, EverybodyMayOpenTheLock) {
  const Process process(long_render("out/a.####.exr"), "umask 077; exec \"$0\" \"$@\"");
  ASSERT_TRUE(appears("out/.becalm.lock"));
  EXPECT_TRUE(
      wait_until([&] { return fs::status(folder_ / "out/.becalm.lock").permissions() == kForEverybody; }));
}

TEST_F(Writers, ALockThatItsLastHolderRemovesIsMadeAnew) {
  fs::create_directories(folder_ / "out");
  const std::string path = folder_ / "out/.becalm.lock";
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  struct flock whole {};
  whole.l_type = F_WRLCK;
  ASSERT_EQ(fcntl(file, F_OFD_SETLK, &whole), 0);
  Process process(command("out/a.####.exr"));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_FALSE(fs::exists(folder_ / "out/a.0001.exr")) << "it waits";
  fs::remove(path);
  close(file);
  EXPECT_EQ(process.wait().status, 0);
}

TEST_F(Writers, ALockThatCannotBeOpenedIsAnError) {
  fs::create_directories(folder_ / "out/.becalm.lock");
  expect_error(becalm(command("out/a.####.exr")), 4, {"out/.becalm.lock: cannot be opened: Is a directory"});
  fs::remove(folder_ / "out/.becalm.lock");
  fs::create_symlink("nowhere", folder_ / "out/.becalm.lock");
  expect_error(becalm(command("out/a.####.exr")), 4, {"out/.becalm.lock: cannot be opened"});
  EXPECT_FALSE(fs::exists(folder_ / "out/a.0001.exr"));
}

TEST_F(Writers, AForbiddenLockIsAnError) {
  write_text(folder_ / ".becalm.lock", "");
  fs::permissions(folder_ / ".becalm.lock", fs::perms::none);
  const bool is_root = geteuid() == 0;
  // Root may open any file unless it gives up that capability.
  const Outcome outcome =
      Process(command("a.####.exr"),
              is_root ? "exec setpriv --bounding-set=-dac_override,-dac_read_search \"$0\" \"$@\""
                      : "exec \"$0\" \"$@\"")
          .wait();
  expect_error(outcome, 4, {".becalm.lock: cannot be opened: Permission denied"});
}

TEST_F(Writers, JobsOfOtherFramesShareAFolderOfNoisyOnes) {
  const auto denoise = [&](const std::string& frames) {
    return std::vector<std::string>{
        "--denoise=balanced", "--keep-noisy", folder_ / "noisy/a.####.exr", "--frames", frames,
        "--context",          "1-400"};
  };
  Process first(long_render("one/a.####.exr", denoise("1-2")));
  ASSERT_TRUE(wait_until([&] { return has_lock(folder_ / "noisy/.becalm.lock"); }));
  render("two/a.####.exr", denoise("200-201"));
  expect_error(becalm(command("two/a.####.exr", denoise("2-3"))), 4,
               {"noisy/a.0001.exr: another becalm is about to write it", "choose another --keep-noisy"});
  first.signal(SIGINT);
  EXPECT_EQ(first.wait().status, 130);
}

TEST_F(Writers, AFolderInAFramesPlaceIsFoundBeforeTheFirstFrame) {
  fs::create_directories(folder_ / "out/a.0003.exr");
  expect_error(becalm(command("out/a.####.exr")), 4, {"out/a.0003.exr: cannot write there: Is a directory"});
  EXPECT_FALSE(fs::exists(folder_ / "out/a.0001.exr"));
}

}  // namespace
}  // namespace becalm::test
