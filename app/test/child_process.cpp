#include "app/test/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "app/cancel.h"
#include "frame/error.h"
#include "frame/mebibytes.h"
#include "frame/names_in.h"

namespace becalm::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kPoll = std::chrono::milliseconds(5);
constexpr auto kMeasureMemory = std::chrono::milliseconds(50);
/// Between SIGTERM and SIGKILL.
constexpr auto kGrace = std::chrono::milliseconds(500);

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Physical memory of all processes of the group.
std::uint64_t memory_of_group(pid_t group) {
  std::uint64_t pages = 0;
  std::error_code error;
  for (const std::string& name : names_in("/proc", error)) {
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    // The process may be gone by now: getline fails then, where stream iterators would throw.
    std::ifstream file("/proc/" + name + "/stat");
    std::string text;
    std::getline(file, text);
    // PID (NAME) STATE PARENT GROUP ... with the resident pages as the 24th field; NAME may hold blanks.
    const std::size_t name_end = text.rfind(')');
    if (name_end == std::string::npos) continue;
    char state = 0;
    long parent = 0, its_group = 0, resident = 0;
    if (std::sscanf(text.c_str() + name_end + 1,
                    " %c %ld %ld %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %ld",
                    &state, &parent, &its_group, &resident) == 4 &&
        its_group == group && resident > 0) {
      pages += static_cast<std::uint64_t>(resident);
    }
  }
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

/// posix_spawn's tables, freed with it.
class SpawnTables {
 public:
  SpawnTables(const std::string& working_folder, const std::string& log_file) {
    constexpr mode_t mode = 0644;
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, log_file.c_str(),
                                     O_WRONLY | O_CREAT | O_APPEND, mode);
    posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
    posix_spawn_file_actions_addchdir_np(&actions_, working_folder.c_str());
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setpgroup(&attributes_, 0);
    sigset_t signals;
    sigemptyset(&signals);
    // becalm ignores both, which its children would inherit.
    sigaddset(&signals, SIGPIPE);
    sigaddset(&signals, SIGXFSZ);
    posix_spawnattr_setsigdefault(&attributes_, &signals);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  }
  ~SpawnTables() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnTables(const SpawnTables&) = delete;
  SpawnTables& operator=(const SpawnTables&) = delete;

  const posix_spawn_file_actions_t* actions() const { return &actions_; }
  const posix_spawnattr_t* attributes() const { return &attributes_; }

 private:
  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

pid_t start(const std::vector<std::string>& arguments, const std::string& working_folder,
            const std::string& log_file) {
  std::vector<std::string> words = arguments;
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const SpawnTables tables(working_folder, log_file);
  pid_t process = -1;
  const int failure = posix_spawnp(&process, pointers.front(), tables.actions(), tables.attributes(),
                                   pointers.data(), environ);
  if (failure != 0) {
    throw Error(ExitStatus::bad_input,
                fmt::format("cannot start {}: {}", arguments.front(), std::strerror(failure)));
  }
  return process;
}

/// The group's first process, waited for.
class Child {
 public:
  explicit Child(const std::function<pid_t()>& start) : group_(start), process_(group_.leader()) {}
  ~Child() { kill(-process_, SIGKILL); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  bool has_ended() {
    if (!ended_) ended_ = wait4(process_, &status_, WNOHANG, &usage_) == process_;
    return ended_;
  }
  void end() {
    kill(-process_, SIGTERM);
    for (const auto last = Clock::now() + kGrace; !has_ended() && Clock::now() < last;) {
      std::this_thread::sleep_for(kPoll);
    }
    if (ended_) return;
    kill(-process_, SIGKILL);
    ended_ = wait4(process_, &status_, 0, &usage_) == process_;
  }
  pid_t leader() const { return process_; }
  int status() const { return status_; }
  /// As the kernel counts it, which counts becalm's own peak too: a process that is spawned shares becalm's
  /// memory at first. 0 where it is not above that.
  std::uint64_t peak_bytes() const {
    constexpr std::uint64_t kibibyte = 1024;
    rusage own = {};
    getrusage(RUSAGE_SELF, &own);
    return usage_.ru_maxrss > own.ru_maxrss ? static_cast<std::uint64_t>(usage_.ru_maxrss) * kibibyte : 0;
  }

 private:
  const ChildGroup group_;
  const pid_t process_;
  int status_ = 0;
  rusage usage_ = {};
  bool ended_ = false;
};

}  // namespace

ChildResult run_child(const std::vector<std::string>& arguments, const std::string& working_folder,
                      const std::string& log_file, const ChildLimits& limits) {
  const Clock::time_point begin = Clock::now();
  Child child([&] { return start(arguments, working_folder, log_file); });
  ChildResult result;
  Clock::time_point measured = begin;
  const auto is_above = [&] {
    return limits.memory_bytes > 0 && result.peak_memory_bytes > limits.memory_bytes;
  };
  while (!child.has_ended()) {
    if (Clock::now() - measured >= kMeasureMemory) {
      measured = Clock::now();
      result.peak_memory_bytes = std::max(result.peak_memory_bytes, memory_of_group(child.leader()));
    }
    result.end = stop_requested()                          ? ChildEnd::interrupted
                 : seconds_since(begin) > limits.timeout_s ? ChildEnd::timed_out
                 : is_above()                              ? ChildEnd::out_of_memory
                                                           : ChildEnd::exited;
    if (result.end != ChildEnd::exited)
      child.end();
    else
      std::this_thread::sleep_for(kPoll);
  }
  result.status = child.status();
  result.peak_memory_bytes = std::max(result.peak_memory_bytes, child.peak_bytes());
  if (result.end == ChildEnd::exited && is_above()) result.end = ChildEnd::out_of_memory;
  return result;
}

std::string describe(const ChildResult& result, const ChildLimits& limits) {
  switch (result.end) {
    case ChildEnd::timed_out:
      return fmt::format("timed out after {:g} s", limits.timeout_s);
    case ChildEnd::out_of_memory:
      return fmt::format("took {:.0f} MiB of memory, and its limit is {:.0f} MiB",
                         mebibytes(result.peak_memory_bytes), mebibytes(limits.memory_bytes));
    case ChildEnd::interrupted:
      return "interrupted";
    case ChildEnd::exited:
      break;
  }
  if (WIFSIGNALED(result.status)) {
    const int signal = WTERMSIG(result.status);
    return fmt::format("crashed (signal {}, {})", signal, strsignal(signal));
  }
  return fmt::format("exit status {}", WEXITSTATUS(result.status));
}

}  // namespace becalm::app
