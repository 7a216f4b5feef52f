#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/folder_lock.h"
#include "app/test/suite.h"

namespace becalm::app {

/// Where cases put their frames: a temporary folder that is removed at the end, or one that is kept.
class WorkFolder {
 public:
  /// `kept` empty: a temporary folder. Throws Error(resource) where it or the folder of a case cannot be
  /// made or another becalm uses it, and Error(usage) where that holds files of others.
  WorkFolder(const std::string& kept, const std::vector<TestCase>& cases);
  ~WorkFolder();
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  /// An empty folder SUITE/NAME/`part` in it, an absolute path. Throws Error(resource).
  std::string folder_of(const TestCase& test, const std::string& part = "") const;

 private:
  std::string path_of(const TestCase& test) const;

  std::string path_;
  std::optional<FolderLock> lock_;  ///< on the cases of a kept folder
  bool is_temporary_;
};

}  // namespace becalm::app
