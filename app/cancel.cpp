#include "app/cancel.h"

#include <unistd.h>

#include <array>
#include <csignal>

namespace becalm::app {
namespace {

std::atomic<bool> stop{false};
std::atomic<int> first_signal{0};
std::array<std::atomic<pid_t>, 1024> child_groups{};  // as many as `becalm test` has jobs; 0: none
std::atomic<int> starting{0};          // groups that are being started and are not in the list yet
std::atomic<bool> end_at_once{false};  // by a second signal
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free &&
                  std::atomic<pid_t>::is_always_lock_free,
              "the signal handler may only touch lock-free atomics");

/// A terminal that is closed often sends two of them, its shell's and the kernel's: the second is no sign of
/// impatience.
bool is_hang_up(int signal) {
  return signal == SIGHUP;
}

/// Unless a group is being started: its thread ends the process then.
void end_if_none_starts() {
  if (starting > 0) return;
  for (const std::atomic<pid_t>& group : child_groups) {
    if (const pid_t leader = group; leader > 0) kill(-leader, SIGKILL);
  }
  _exit(process_status(ExitStatus::interrupted));
}

/// While it lives, a group is being started. The order of the atomics matters: either the signal handler sees
/// the count, or this sees that the process is to end.
class Starting {
 public:
  Starting() {
    ++starting;
    if (!end_at_once) return;
    end();
    for (;;) pause();  // another thread ends the process
  }
  ~Starting() { end(); }
  Starting(const Starting&) = delete;
  Starting& operator=(const Starting&) = delete;

 private:
  void end() {
    --starting;
    if (end_at_once) end_if_none_starts();
  }
};

extern "C" void on_signal(int signal) {
  int none = 0;
  const bool is_first = first_signal.compare_exchange_strong(none, signal);
  if (!is_first && !is_hang_up(signal)) {
    end_at_once = true;
    end_if_none_starts();
  }
  stop = true;
}

}  // namespace

void catch_signals() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction of_hang_up = {};
  sigaction(SIGHUP, nullptr, &of_hang_up);
  const bool goes_on_without_terminal = of_hang_up.sa_handler == SIG_IGN;  // nohup
  if (!goes_on_without_terminal) sigaction(SIGHUP, &action, nullptr);
  // Ignored by a parent, it would end children without a status to wait for.
  action.sa_handler = SIG_DFL;
  sigaction(SIGCHLD, &action, nullptr);
  action.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &action, nullptr);
  sigaction(SIGXFSZ, &action, nullptr);  // a limit of files' sizes is an error of writing
}

ChildGroup::ChildGroup(const std::function<pid_t()>& start) {
  const Starting starts;
  leader_ = start();
  for (std::atomic<pid_t>& place : child_groups) {
    pid_t none = 0;
    if (!place.compare_exchange_strong(none, leader_)) continue;
    place_ = &place;
    return;
  }
}
ChildGroup::~ChildGroup() {
  if (place_ != nullptr) *place_ = 0;
}

const std::atomic<bool>& stop_requested() {
  return stop;
}
void request_stop() {
  stop = true;
}
bool interrupted() {
  return first_signal != 0;
}
int process_status(ExitStatus status) {
  if (status == ExitStatus::interrupted && is_hang_up(first_signal)) return 128 + SIGHUP;
  return static_cast<int>(status);
}
void stop_if_asked() {
  if (interrupted()) throw Error(ExitStatus::interrupted, "interrupted; nothing was written");
}

}  // namespace becalm::app
