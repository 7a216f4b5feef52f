#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include "frame/error.h"

namespace becalm {

/// Throws Error(bad_input) for what is there and is no regular file: a pipe can be read only once, and a FIFO
/// that nobody writes to would wait for ever. `expected` is with its article, as "an EXR file".
inline void refuse_other_than_file(const std::string& path, const std::string& expected) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    throw Error(ExitStatus::bad_input, path + ": not a file, expected " + expected);
}

}  // namespace becalm
