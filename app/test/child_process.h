#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace becalm::app {

struct ChildLimits {
  double timeout_s = 600.0;
  std::uint64_t memory_bytes = 0;  ///< 0: no limit
};

enum class ChildEnd {
  exited,         ///< by itself, or by a signal that becalm did not send
  timed_out,      ///< and was ended
  out_of_memory,  ///< took more than its limit, and was ended
  interrupted     ///< becalm was asked to stop, and ended it
};

struct ChildResult {
  ChildEnd end = ChildEnd::exited;
  int status = 0;  ///< what waitpid tells
  std::uint64_t peak_memory_bytes = 0;

  bool succeeded() const { return end == ChildEnd::exited && status == 0; }
};

/// Runs a program to its end, in a process group of its own, with standard output and error at the end of
/// `log_file` and an empty standard input. Whatever of the group is left when its first process ends, or when
/// a limit ends it, is killed.
///
/// The limit of memory is on what the group has in physical memory, measured 20 times a second, and on the
/// peak of one process that the kernel counts, where that is above becalm's own: a limit on addresses
/// (RLIMIT_AS) would end programs that reserve more than they use, as becalm's own filter does. A group may
/// be above it for a moment.
///
/// Throws Error(bad_input) if the program cannot be started.
ChildResult run_child(const std::vector<std::string>& arguments, const std::string& working_folder,
                      const std::string& log_file, const ChildLimits& limits);

/// How it ended, such as `exit status 3`, `crashed (signal 11, Segmentation fault)`, `timed out after 2 s`.
std::string describe(const ChildResult& result, const ChildLimits& limits);

}  // namespace becalm::app
