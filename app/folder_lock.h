#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace becalm::app {

/// Reserves file names in a folder against other processes, by locks on `.becalm.lock` there: a byte for each
/// name. The system drops the locks when the process ends, however it ends. Everybody may open the file, and
/// the last holder removes it.
class FolderLock {
 public:
  /// Throws Error(resource) naming the first of the names that another process holds, for which the user may
  /// choose another value of `option`; also where the file is there and cannot be opened. Throws
  /// Error(interrupted). Where the file system knows no locks, nothing is held.
  FolderLock(std::filesystem::path folder, const std::vector<std::string>& names, std::string_view option);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  void open();
  bool take(const std::vector<std::string>& names, std::string_view option, bool can_wait);
  bool is_in_place() const;
  void close();
  void release();

  std::filesystem::path folder_;
  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace becalm::app
