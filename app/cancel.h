#pragma once

#include <sys/types.h>

#include <atomic>
#include <functional>

#include "frame/error.h"

namespace becalm::app {

/// From now on SIGINT, SIGTERM and SIGHUP ask the command to stop and leave whole files only; a second SIGINT
/// or SIGTERM ends the process at once, and its ChildGroups. SIGHUP stays ignored if it was, as under nohup.
/// SIGPIPE is ignored: whoever reads the progress may leave before the last frame.
void catch_signals();

/// True once a signal came or `request_stop` was called; what the tracer and the loops over frames look at.
const std::atomic<bool>& stop_requested();

/// Stops the command's other threads after one of them failed.
void request_stop();

/// Whether a signal was the reason.
bool interrupted();

/// A process group that is killed if a second signal ends this process; the first 1024 that live at a time.
class ChildGroup {
 public:
  /// `start` starts the group's first process and returns it. A second signal that comes meanwhile waits for
  /// it, so that no child is left behind.
  explicit ChildGroup(const std::function<pid_t()>& start);
  ~ChildGroup();
  ChildGroup(const ChildGroup&) = delete;
  ChildGroup& operator=(const ChildGroup&) = delete;

  pid_t leader() const { return leader_; }

 private:
  pid_t leader_ = 0;
  std::atomic<pid_t>* place_ = nullptr;  ///< where the signal handler looks
};

/// The number with which the process ends: that of the status, but 129 if it was interrupted by SIGHUP.
int process_status(ExitStatus status);

/// For loops before anything is written: throws Error(interrupted) once a signal came.
void stop_if_asked();

}  // namespace becalm::app
