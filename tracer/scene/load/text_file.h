#pragma once

#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include "frame/error.h"

namespace becalm::tracer {

/// The bytes of a file; nothing if it cannot be read.
inline std::optional<std::string> read_text_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  try {
    return std::string{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  } catch (const std::ios_base::failure&) {  // a folder opens as a file would, and cannot be read
    return std::nullopt;
  }
}

/// Throws: the file at this path says something that cannot be read.
[[noreturn]] inline void fail_in_file(const std::string& path, const std::string& message) {
  throw Error(ExitStatus::bad_input, path + ": " + message);
}

}  // namespace becalm::tracer
