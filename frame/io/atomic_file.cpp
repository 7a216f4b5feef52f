#include "frame/io/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "frame/error.h"

namespace becalm::io {
namespace fs = std::filesystem;

namespace {

/// Makes a rename in the folder survive a power cut. Some file systems refuse it, and then there is no more
/// to do.
void sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

/// Gives the file the mode of the one whose place it takes, which may be shared more or less than new files
/// are. Who may not set it leaves the new file's.
void take_mode_of(const std::string& path, int descriptor) {
  constexpr mode_t permissions = 0777;
  struct stat there {};
  if (::stat(path.c_str(), &there) != 0 || !S_ISREG(there.st_mode)) return;
  [[maybe_unused]] const int refused = ::fchmod(descriptor, there.st_mode & permissions);
}

}  // namespace

AtomicFile::AtomicFile(std::string path) : path_(std::move(path)) {
  const fs::path folder = fs::path(path_).parent_path();
  std::error_code error;
  if (!folder.empty()) fs::create_directories(folder, error);
  if (error) fail("make its folder", error.value());
  if (fs::is_directory(path_, error)) fail("write it", EISDIR);

  // Several threads may write one path, and a killed process of the same number may have left its partial
  // file.
  static std::atomic<unsigned> counter{0};
  constexpr int max_attempts = 1000;
  for (int attempt = 0; attempt < max_attempts && file_ == nullptr; ++attempt) {
    partial_path_ = fmt::format("{}.partial.{}.{}", path_, ::getpid(), counter++);
    file_ = std::fopen(partial_path_.c_str(), "wbxe");
    if (file_ == nullptr && errno != EEXIST) break;
  }
  if (file_ == nullptr) {
    const int error_number = errno;
    partial_path_.clear();
    fail("write it", error_number);
  }
}

AtomicFile::~AtomicFile() {
  if (file_ != nullptr) std::fclose(file_);
  if (!partial_path_.empty()) ::unlink(partial_path_.c_str());
}

void AtomicFile::fail(const std::string& doing, int error_number) {
  failure_ = fmt::format("{}: cannot {}: {}", path_, doing, std::generic_category().message(error_number));
  throw Error(ExitStatus::resource, failure_);
}

void AtomicFile::fail_if_failed() const {
  if (!failure_.empty()) throw Error(ExitStatus::resource, failure_);
}

void AtomicFile::write(const char* bytes, std::size_t size) {
  fail_if_failed();
  if (std::fwrite(bytes, 1, size, file_) != size) fail("write it", errno);
  position_ += size;
}

void AtomicFile::seek(std::uint64_t position) {
  fail_if_failed();
  if (::fseeko(file_, static_cast<off_t>(position), SEEK_SET) != 0) fail("write it", errno);
  position_ = position;
}

void AtomicFile::finish() {
  fail_if_failed();
  take_mode_of(path_, ::fileno(file_));
  if (std::fflush(file_) != 0 || ::fsync(::fileno(file_)) != 0) fail("write it", errno);
  const int closed = std::fclose(file_);
  file_ = nullptr;
  if (closed != 0) fail("write it", errno);
}

void AtomicFile::commit() {
  fail_if_failed();
  if (file_ != nullptr) finish();
  if (std::rename(partial_path_.c_str(), path_.c_str()) != 0) fail("rename its partial file", errno);
  partial_path_.clear();
  sync_folder(fs::path(path_).parent_path());
}

}  // namespace becalm::io
