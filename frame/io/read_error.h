#pragma once

#include <string>
#include <system_error>

#include "frame/error.h"

namespace becalm::io {

/// The system does not let a file or folder be read, which says nothing of what is in it.
class ReadError : public Error {
 public:
  using Error::Error;
};

/// Throws ReadError of the path, `what` cannot be done with it and the system's reason: bad_input where the
/// path is wrong or forbidden, resource for what the system lacks, such as memory, descriptors or a device
/// that answers.
[[noreturn]] void fail_to_read(const std::string& path, const std::error_code& reason,
                               const std::string& what = "cannot be read");

}  // namespace becalm::io
