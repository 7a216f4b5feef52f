#include "app/cancel.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

namespace becalm::app {
namespace {

/// A process that leads a group of its own and ignores what asks it to end.
pid_t start_deaf_process() {
  const pid_t process = fork();
  if (process == 0) {
    setpgid(0, 0);
    for (;;) pause();
  }
  setpgid(process, process);
  return process;
}

/// Ends this process by two signals that come before ChildGroup knows the group; `told` gets its leader.
void end_while_starting(int told) {
  catch_signals();
  const ChildGroup group([&] {
    const pid_t leader = start_deaf_process();
    if (write(told, &leader, sizeof leader) != sizeof leader) _exit(1);
    raise(SIGINT);
    raise(SIGTERM);
    return leader;
  });
  _exit(2);  // not reached
}

TEST(Cancel, ASecondSignalLeavesNoChildThatIsBeingStarted) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t process = fork();
  if (process == 0) end_while_starting(ends[1]);
  close(ends[1]);  // its other holders are that process and its child: when both have ended, the pipe has
  pid_t leader = 0;
  ASSERT_EQ(read(ends[0], &leader, sizeof leader), static_cast<ssize_t>(sizeof leader));
  int status = 0;
  ASSERT_EQ(waitpid(process, &status, 0), process);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  constexpr int patience_ms = 20000;
  pollfd end{.fd = ends[0], .events = 0, .revents = 0};
  EXPECT_EQ(poll(&end, 1, patience_ms), 1) << "the child lives on";
  kill(-leader, SIGKILL);
  close(ends[0]);
}

}  // namespace
}  // namespace becalm::app
