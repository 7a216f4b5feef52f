#include "app/folder_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <functional>

#include "app/content_hash.h"
#include "frame/error.h"

namespace becalm::app {
namespace {

/// Locks `length` bytes from `start`; 0 means all that follow. The lock belongs to the open file and not to
/// the process, so that closing another descriptor of the file does not drop it.
bool lock(int file, off_t start, off_t length) {
  struct flock range {};
  range.l_type = F_WRLCK;
  range.l_whence = SEEK_SET;
  range.l_start = start;
  range.l_len = length;
  return ::fcntl(file, F_OFD_SETLK, &range) == 0;
}

bool is_held_by_another(int error) {
  return error == EAGAIN || error == EACCES;
}

/// The byte that stands for a name.
off_t place_of(const std::string& name) {
  ContentHash hash;
  hash.add(name);
  return static_cast<off_t>(hash.value() >> 2);
}

}  // namespace

FolderLock::FolderLock(std::filesystem::path folder, const std::vector<std::string>& names)
    : folder_(std::move(folder)), path_(folder_ / ".becalm.lock") {
  // The last holder may have removed the file between our opening and locking it.
  while (open()) {
    take(names);
    struct stat own {};
    struct stat there {};
    if (::fstat(file_, &own) != 0 || (::stat(path_.c_str(), &there) == 0 && own.st_ino == there.st_ino))
      return;
    ::close(file_);
  }
}

FolderLock::~FolderLock() {
  if (file_ < 0) return;
  if (lock(file_, 0, 0)) ::unlink(path_.c_str());  // nobody else is left
  ::close(file_);
}

bool FolderLock::open() {
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  return file_ >= 0;
}

void FolderLock::take(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (lock(file_, place_of(name), 1)) continue;
    if (!is_held_by_another(errno)) return;
    ::close(file_);
    throw Error(
        ExitStatus::resource,
        fmt::format("{}: another becalm is about to write it; wait for that one, or choose another -o",
                    (folder_ / name).string()));
  }
}

}  // namespace becalm::app
