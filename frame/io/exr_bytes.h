#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>

namespace becalm::io {

/// An EXR file as bytes, for what OpenEXR does not tell: "OpenEXR File Layout", openexr.com.
class ExrBytes {
 public:
  /// Throws std::system_error where the file cannot be opened.
  explicit ExrBytes(const std::string& path);
  ExrBytes(const ExrBytes&) = delete;
  ExrBytes& operator=(const ExrBytes&) = delete;
  ~ExrBytes();

  /// Integers are stored with their lowest byte first. Throws std::runtime_error where the file ends before,
  /// and std::system_error where it cannot be read.
  template <class T>
  T read(std::uint64_t offset) const {
    T value;
    std::memcpy(&value, bytes(offset, sizeof value), sizeof value);
    return value;
  }

  /// Whether the file begins as EXR files do.
  bool is_exr() const;
  bool is_multi_part() const;
  /// Where the headers end. Throws std::runtime_error where an attribute's value is not of the size that it
  /// says, or ends behind the file's end.
  std::uint64_t headers_end() const;

 private:
  /// Reads the bytes into the block; false where the file ends before.
  bool load(std::uint64_t offset, std::size_t count) const;
  const char* bytes(std::uint64_t offset, std::size_t count) const;
  std::string name(std::uint64_t& offset) const;
  std::uint64_t header_end(std::uint64_t offset) const;
  void require_value(const std::string& type, std::uint64_t offset, std::uint64_t size) const;

  int descriptor_;
  mutable std::array<char, 4096> block_{};  ///< what was read last
  mutable std::uint64_t block_offset_ = 0;
  mutable std::size_t block_size_ = 0;
};

}  // namespace becalm::io
