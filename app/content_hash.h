#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace becalm::app {

/// Tells contents apart, which is all that is asked of it: FNV-1a over words of 8 bytes, with a rotation that
/// lets the high bits of a word reach the low ones. Some 5 GB/s.
class ContentHash {
 public:
  /// Equal bytes in other portions give another hash, unless all portions but the last are of whole words.
  void add(std::string_view bytes);
  void add(std::uint64_t word);
  /// Throws Error(bad_input) if the file cannot be read.
  void add_file(const std::filesystem::path& path);
  /// Sixteen hexadecimal digits.
  std::string text() const;
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace becalm::app
