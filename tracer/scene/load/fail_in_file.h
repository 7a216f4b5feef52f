#pragma once

#include <string>

#include "frame/error.h"

namespace becalm::tracer {

/// Throws: the file at this path says something that cannot be read.
[[noreturn]] inline void fail_in_file(const std::string& path, const std::string& message) {
  throw Error(ExitStatus::bad_input, path + ": " + message);
}

/// While an error is handled: throws it again where it is no fault of the file that was read.
inline void rethrow_if_of_system(const std::runtime_error& error) {
  const auto* own = dynamic_cast<const Error*>(&error);
  if (own != nullptr && own->status() == ExitStatus::resource) throw;
}

}  // namespace becalm::tracer
