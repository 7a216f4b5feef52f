#pragma once

#include <fstream>
#include <optional>
#include <string>

namespace becalm {

/// The bytes of a file; nothing if it cannot be read (a folder can be opened, but not read).
inline std::optional<std::string> read_text_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  while (file) {
    constexpr std::size_t block = std::size_t{1} << 20;
    const std::size_t size = text.size();
    text.resize(size + block);
    file.read(text.data() + size, block);
    text.resize(size + static_cast<std::size_t>(file.gcount()));
  }
  return file.eof() ? std::make_optional(std::move(text)) : std::nullopt;
}

}  // namespace becalm
