#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace becalm::app {

/// A hash that tells contents apart and is not cryptographic: FNV-1a over words of 8 bytes, with a rotation
/// that lets the high bits of a word reach the low ones. Some 5 GB/s.
class ContentHash {
 public:
  /// Bytes may come in portions of multiples of 8 without changing the hash; other portions change it.
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
