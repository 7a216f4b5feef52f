#pragma once

#include <string>

#include "frame/error.h"

namespace becalm::tracer {

/// Throws: the file at this path says something that cannot be read.
[[noreturn]] inline void fail_in_file(const std::string& path, const std::string& message) {
  throw Error(ExitStatus::bad_input, path + ": " + message);
}

}  // namespace becalm::tracer
