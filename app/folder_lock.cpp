#include "app/folder_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <optional>
#include <system_error>
#include <thread>

#include "app/cancel.h"
#include "app/content_hash.h"
#include "frame/error.h"
#include "frame/io/sequence.h"

namespace becalm::app {
namespace {

/// An exclusive lock on `length` bytes from `start`; 0 means all that follow.
struct flock exclusive(off_t start, off_t length) {
  struct flock range {};
  range.l_type = F_WRLCK;
  range.l_whence = SEEK_SET;
  range.l_start = start;
  range.l_len = length;
  return range;
}

/// The lock belongs to the open file and not to the process, so that closing another descriptor of the file
/// does not drop it.
bool lock(int file, off_t start, off_t length) {
  struct flock range = exclusive(start, length);
  return ::fcntl(file, F_OFD_SETLK, &range) == 0;
}

/// Whether another process holds all of the file, as the last one does before it removes it.
bool is_being_removed(int file, off_t place) {
  struct flock range = exclusive(place, 1);
  return ::fcntl(file, F_OFD_GETLK, &range) == 0 && range.l_type != F_UNLCK && range.l_start == 0 &&
         range.l_len == 0;
}

bool is_held_by_another(int error) {
  return error == EAGAIN || error == EACCES;
}

off_t hash_of(const std::string& text) {
  ContentHash hash;
  hash.add(text);
  return static_cast<off_t>(hash.value() >> 2);
}

/// The byte that stands for a name. Frames of one sequence have adjacent bytes: the system joins locks on
/// those, and each further lock costs time for all that are there.
off_t place_of(const std::string& name) {
  const std::optional<io::NamedFrame> frame = io::frame_in_name(name);
  if (!frame) return hash_of(name);
  return hash_of(*io::pattern_of_frame(name)) + static_cast<std::uint32_t>(frame->number);
}

/// Earlier programs lock the hash of the whole name. That is done, too, so that they are noticed, unless
/// there are so many names that it takes long.
constexpr std::size_t kMostScattered = 100;

std::vector<off_t> places_of(const std::string& name, std::size_t names) {
  if (names > kMostScattered) return {place_of(name)};
  return {place_of(name), hash_of(name)};
}

constexpr int kOpenFlags = O_RDWR | O_CLOEXEC | O_NOFOLLOW;

/// The new file, open, with a mode that does not depend on the umask; -1 as `open`.
int make_for_everybody(const std::filesystem::path& path) {
  constexpr mode_t for_everybody = 0666;
  const int file = ::open(path.c_str(), kOpenFlags | O_CREAT | O_EXCL, for_everybody);
  if (file >= 0) {
    [[maybe_unused]] const int refused = ::fchmod(file, for_everybody);  // by file systems without modes
  }
  return file;
}

}  // namespace

FolderLock::FolderLock(std::filesystem::path folder, const std::vector<std::string>& names,
                       std::string_view option)
    : folder_(std::move(folder)), path_(folder_ / ".becalm.lock") {
  constexpr std::chrono::milliseconds wait(10);
  constexpr int most_waits = 500;
  try {
    open();
    // The last holder may be about to remove it, or have removed it between our opening and locking it.
    for (int waits = 0; !take(names, option, /*can_wait=*/waits < most_waits) || !is_in_place(); ++waits) {
      close();
      std::this_thread::sleep_for(wait);
      open();
    }
  } catch (...) {
    release();
    throw;
  }
}

FolderLock::~FolderLock() {
  release();
}

void FolderLock::open() {
  do {
    // Not made by the same call: in a folder with the sticky bit, O_CREAT is refused for another's file.
    file_ = ::open(path_.c_str(), kOpenFlags);
    if (file_ < 0 && errno == ENOENT) file_ = make_for_everybody(path_);
  } while (file_ < 0 && errno == EEXIST);
  if (file_ >= 0) return;
  throw Error(ExitStatus::resource,
              fmt::format("{}: cannot be opened: {}; it tells two writers of one file apart: remove it where "
                          "no other becalm writes",
                          path_.string(), std::generic_category().message(errno)));
}

/// False where the file is about to be removed and the caller `can_wait`.
bool FolderLock::take(const std::vector<std::string>& names, std::string_view option, bool can_wait) {
  for (const std::string& name : names) {
    stop_if_asked();
    for (const off_t place : places_of(name, names.size())) {
      if (lock(file_, place, 1)) continue;
      if (!is_held_by_another(errno)) return true;
      if (can_wait && is_being_removed(file_, place)) return false;
      throw Error(
          ExitStatus::resource,
          fmt::format("{}: another becalm is about to write it; wait for that one, or choose another {}",
                      (folder_ / name).string(), option));
    }
  }
  return true;
}

/// Whether the open file is the one that others find.
bool FolderLock::is_in_place() const {
  struct stat own {};
  struct stat there {};
  return ::fstat(file_, &own) != 0 || (::stat(path_.c_str(), &there) == 0 && own.st_ino == there.st_ino);
}

void FolderLock::close() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
}

void FolderLock::release() {
  if (file_ < 0) return;
  if (lock(file_, 0, 0) && is_in_place()) ::unlink(path_.c_str());  // nobody else is left
  close();
}

}  // namespace becalm::app
