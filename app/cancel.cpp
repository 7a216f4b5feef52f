#include "app/cancel.h"

#include <unistd.h>

#include <csignal>

#include "frame/error.h"

namespace becalm::app {
namespace {

std::atomic<bool> stop{false};
std::atomic<bool> signalled{false};
static_assert(std::atomic<bool>::is_always_lock_free, "the signal handler may only touch lock-free atomics");

extern "C" void on_signal(int) {
  if (signalled.exchange(true)) _exit(static_cast<int>(ExitStatus::interrupted));
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
  action.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &action, nullptr);
  sigaction(SIGXFSZ, &action, nullptr);  // a limit of files' sizes is an error of writing
}

const std::atomic<bool>& stop_requested() {
  return stop;
}
void request_stop() {
  stop = true;
}
bool interrupted() {
  return signalled;
}
void stop_if_asked() {
  if (interrupted()) throw Error(ExitStatus::interrupted, "interrupted; nothing was written");
}

}  // namespace becalm::app
