// Standard streams that cannot be written: frames come first, and lost data is an error.

#include <gtest/gtest.h>

#include "tests/end_to_end/harness.h"

namespace becalm::test {
namespace {

/// Standard error is a pipe whose reader has gone.
std::string into_closed_pipe(const std::string& trap) {
  return trap + R"(exec 3> >(:); wait $!; exec "$0" "$@" 2>&3 3>&-)";
}

class StandardStreams : public testing::Test {
 protected:
  /// Every way in which standard error can fail.
  const std::vector<std::string> scripts_{
      R"(exec "$0" "$@" 2>/dev/full)",    R"(exec "$0" "$@" 2>&-)", R"(exec "$0" "$@" <&- >&- 2>&-)",
      into_closed_pipe("trap '' PIPE; "), into_closed_pipe(""),
  };
  TempFolder folder_;
  std::string scene_ = write_scene(folder_);
};

TEST_F(StandardStreams, ProgressThatCannotBeWrittenCostsNoFrame) {
  const std::string noisy = folder_ / "noisy.####.exr";
  becalm_done(
      {"render", scene_, "-o", noisy, "--frames", "1-2", "--spp", "1", "--aovs", "albedo", "--quiet"});
  for (const std::string& script : scripts_) {
    const std::string rendered = folder_ / "rendered.####.exr";
    EXPECT_EQ(
        Process({"render", scene_, "-o", rendered, "--frames", "1-2", "--spp", "1", "--profile"}, script)
            .wait()
            .status,
        0)
        << script;
    expect_same_beauty(noisy, rendered, 1, 2);
    const std::string calm = folder_ / "calm.####.exr";
    EXPECT_EQ(
        Process({"denoise", noisy, "-o", calm, "--set", "smooth=none", "--profile"}, script).wait().status, 0)
        << script;
    for (const std::string& pattern : {rendered, calm}) {
      for (const int frame : {1, 2}) EXPECT_NO_THROW(read_frame(frame_path(pattern, frame))) << script;
      for (const int frame : {1, 2}) fs::remove(frame_path(pattern, frame));
    }
  }
}

TEST_F(StandardStreams, FailuresKeepTheirStatus) {
  for (const std::string& script : scripts_) {
    EXPECT_EQ(Process({"denoise", folder_ / "none.exr", "-o", folder_ / "out.exr"}, script).wait().status,
              kBadInput)
        << script;
  }
}

TEST_F(StandardStreams, StandardOutputThatCannotBeWrittenIsAnError) {
  for (const char* redirection : {">/dev/full", ">&-"}) {
    EXPECT_EQ(becalm_redirected({"--help"}, redirection).status, kResource) << redirection;
    EXPECT_EQ(becalm_redirected({"denoise", "--help"}, redirection).status, kResource) << redirection;
    EXPECT_EQ(becalm_redirected({"--version"}, redirection).status, kResource) << redirection;
    EXPECT_EQ(becalm_redirected({"info", scene_}, redirection).status, kResource) << redirection;
  }
}

}  // namespace
}  // namespace becalm::test
