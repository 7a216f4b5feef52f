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

}  // namespace
}  // namespace becalm::app
