#pragma once

#include <stdexcept>
#include <string>

namespace becalm {

/// Exit statuses of the command line; the numbers are part of its contract.
enum class ExitStatus {
  done = 0,
  comparison_failed = 1,
  usage = 2,
  bad_input = 3,
  resource = 4,
  interrupted = 130
};

/// The one exception type at the boundaries (command line, files, scenes). `what()` is a single line that
/// names the file, the field and the offending value, and what was expected instead. Ends the program
/// in `main`, unless the command can do without the file.
class Error : public std::runtime_error {
 public:
  Error(ExitStatus status, const std::string& message) : std::runtime_error(message), status_(status) {}
  ExitStatus status() const { return status_; }

 private:
  ExitStatus status_;
};

}  // namespace becalm
