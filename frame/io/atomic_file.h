#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace becalm::io {

/// How much longer a partial file's name is at most: `.partial.PID.N` with Linux's largest process number.
inline constexpr std::size_t kLongestPartialSuffix = std::string_view(".partial.4194304.4294967295").size();

/// A file that appears at its place whole or not at all. It is written as `PATH.partial.PID.N` beside its
/// place, where no pattern for `.exr` files finds it, flushed to the disk and renamed, with the mode of the
/// file that it replaces. Until then, and after any failure, whatever was at `path`
/// before stays there. Every failure throws Error(resource) naming `path`.
class AtomicFile {
 public:
  /// Makes the parent folders and the partial file.
  explicit AtomicFile(std::string path);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  /// Removes the partial file unless it was committed.
  ~AtomicFile();

  void write(const char* bytes, std::size_t size);
  std::uint64_t position() const { return position_; }
  void seek(std::uint64_t position);

  /// Ends writing: flushes the file to the disk, so that nothing but the rename is left to commit(). Also
  /// throws if an earlier write or seek failed whose exception somebody swallowed.
  void finish();
  /// After finish(), or with it.
  void commit();

 private:
  [[noreturn]] void fail(const std::string& doing, int error_number);
  void fail_if_failed() const;

  std::string path_;
  std::string partial_path_;
  std::FILE* file_ = nullptr;
  std::uint64_t position_ = 0;
  std::string failure_;
};

}  // namespace becalm::io
