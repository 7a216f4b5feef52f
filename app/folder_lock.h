#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace becalm::app {

/// Names of files in a folder that no other process may write meanwhile: locks on `.becalm.lock` there, a
/// byte a name, which the system drops with the process, however that ends. The file is removed by the last
/// one.
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
