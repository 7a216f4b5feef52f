#include "app/test/work_folder.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "frame/error.h"

namespace becalm::app {

namespace fs = std::filesystem;

namespace {

/// In the folder of a kept case: what is beside it is becalm's, and may be replaced.
constexpr const char* kMarker = ".becalm-test";

}  // namespace

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
  const fs::path of_case = fs::path(path_) / test.suite / test.name;
  const fs::path marker = of_case / kMarker;
  std::error_code error;
  if (!is_temporary_ && fs::exists(of_case, error) && !fs::is_empty(of_case, error) &&
      !fs::exists(marker, error)) {
    throw Error(ExitStatus::usage,
                fmt::format("--keep: {} holds files of others; choose another folder", of_case.string()));
  }
  fs::remove_all(folder, error);
  if (!error) fs::create_directories(folder, error);
  if (!error && !is_temporary_) std::ofstream(marker) << "Made by becalm test, and replaced by it.\n";
  if (error)
    throw Error(ExitStatus::resource, fmt::format("{}: cannot make the folder: {}", folder, error.message()));
  return folder;
}

}  // namespace becalm::app
