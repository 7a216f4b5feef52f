#pragma once

#include <fstream>
#include <iterator>
#include <optional>
#include <string>

namespace becalm::tracer {

/// The bytes of a file; nothing if it cannot be read.
inline std::optional<std::string> read_text_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) return std::nullopt;
  return text;
}

}  // namespace becalm::tracer
