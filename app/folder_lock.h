#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace becalm::app {

/// Reserves file names in a folder against other processes, by locks on `.becalm.lock` there: one byte for
/// each name. The system drops the locks when the process ends, however it ends. The last holder removes the
/// file.
class FolderLock {
 public:
  /// Throws Error(resource) naming the first of the names that another process holds. Where the file system
  /// knows no locks, nothing is held.
  FolderLock(std::filesystem::path folder, const std::vector<std::string>& names);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  bool open();
  void take(const std::vector<std::string>& names);

  std::filesystem::path folder_;
  std::filesystem::path path_;
  int file_ = -1;
};

}  // namespace becalm::app
