#include "app/test/work_folder.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "frame/error.h"

namespace becalm::app {

namespace fs = std::filesystem;

namespace {

/// In the folder of a kept case: what is beside it is becalm's, and may be replaced.
constexpr const char* kMarker = ".becalm-test";

[[noreturn]] void fail_to_make(const std::string& folder, const std::error_code& error,
                               const std::string& advice = "") {
  throw Error(ExitStatus::resource,
              fmt::format("{}: cannot make the folder: {}{}", folder, error.message(), advice));
}

std::string make_temporary_folder() {
  std::error_code error;
  // temp_directory_path would not tell the name of a folder that is not there.
  const char* given = std::getenv("TMPDIR");
  const bool is_given = given != nullptr && *given != '\0';
  const fs::path parent = is_given ? fs::path(given) : fs::temp_directory_path(error);
  const char* advice = "; TMPDIR names the folder to make it in";
  if (error) fail_to_make("a temporary folder", error, advice);
  std::string path = fs::absolute(parent / "becalm_test_XXXXXX").string();
  if (mkdtemp(path.data()) == nullptr) fail_to_make(path, {errno, std::generic_category()}, advice);
  return path;
}

}  // namespace

WorkFolder::WorkFolder(const std::string& kept) : is_temporary_(kept.empty()) {
  if (is_temporary_) {
    path_ = make_temporary_folder();
    return;
  }
  path_ = fs::absolute(kept).lexically_normal().string();
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) fail_to_make(path_, error);
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
  if (error) fail_to_make(folder, error);
  return folder;
}

}  // namespace becalm::app
