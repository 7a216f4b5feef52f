#include "app/test/work_folder.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "frame/error.h"

namespace becalm::app {

namespace fs = std::filesystem;

WorkFolder::WorkFolder(const std::string& kept) : is_temporary_(kept.empty()) {
  std::error_code error;
  if (is_temporary_) {
    path_ = (fs::temp_directory_path(error) / "becalm_test_XXXXXX").string();
    if (!error && mkdtemp(path_.data()) == nullptr) error.assign(errno, std::generic_category());
  } else {
    path_ = fs::absolute(kept).lexically_normal().string();
    fs::create_directories(path_, error);
  }
  if (error)
    throw Error(ExitStatus::resource, fmt::format("{}: cannot make the folder: {}", path_, error.message()));
}

WorkFolder::~WorkFolder() {
  std::error_code ignored;
  if (is_temporary_) fs::remove_all(path_, ignored);
}

std::string WorkFolder::folder_of(const TestCase& test, const std::string& part) const {
  fs::path path = fs::path(path_) / test.suite / test.name;
  if (!part.empty()) path /= part;
  const std::string folder = path.string();
  std::error_code error;
  fs::remove_all(folder, error);
  if (!error) fs::create_directories(folder, error);
  if (error)
    throw Error(ExitStatus::resource, fmt::format("{}: cannot make the folder: {}", folder, error.message()));
  return folder;
}

}  // namespace becalm::app
