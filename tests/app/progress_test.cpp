#include "app/progress.h"

#include <gtest/gtest.h>

#include <string>

namespace becalm::app {
namespace {

/// What is said of frame 2 of 4 while it is half done; standard error is no terminal while it is captured.
std::string said_at_work(const ProgressOptions& options) {
  testing::internal::CaptureStderr();
  Progress(options).update(2, 1.5);
  return testing::internal::GetCapturedStderr();
}

TEST(Progress, TellsAFrameThatTakesLongWithoutATerminal) {
  using std::chrono::milliseconds;
  const std::string said = said_at_work({.total = 4, .work = 4, .say_every = milliseconds(0)});
  EXPECT_TRUE(said.starts_with("frame 2: at work, 0 of 4 done, ")) << said;
  EXPECT_TRUE(said.ends_with(" left\n")) << said;
  EXPECT_EQ(said_at_work({.total = 4, .work = 4}), "") << "only after half a minute";
  EXPECT_EQ(said_at_work({.total = 4, .work = 4, .quiet = true, .say_every = milliseconds(0)}), "");
}

TEST(Progress, TheTimeThatAFilterStillTakesIsTold) {
  using std::chrono::milliseconds;
  Progress progress({.total = 4, .work = 4, .steps = 8, .say_every = milliseconds(0)});
  const auto said = [&](std::size_t steps_done) {
    testing::internal::CaptureStderr();
    progress.update_filter(2, steps_done);
    return testing::internal::GetCapturedStderr();
  };
  testing::internal::CaptureStderr();
  progress.update(4, 4.0);
  EXPECT_EQ(testing::internal::GetCapturedStderr().find("left"), std::string::npos) << "nobody knows";
  EXPECT_EQ(said(0).find("left"), std::string::npos);
  EXPECT_TRUE(said(2).starts_with("frame 2: at work, 0 of 4 done, "));
  EXPECT_TRUE(said(3).ends_with(" left\n"));
}

TEST(Progress, AFilterAloneTellsItsOwnRate) {
  Progress progress({.total = 2, .steps = 4, .say_every = std::chrono::milliseconds(0)});
  testing::internal::CaptureStderr();
  progress.update_filter(1, 2);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("steps/s"), std::string::npos) << said;
  EXPECT_EQ(said.find("nan"), std::string::npos) << said;
}

}  // namespace
}  // namespace becalm::app
