#include "app/test/work_folder.h"

#include <fmt/format.h>
#include <stdlib.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "app/outputs.h"
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

/// Throws for a folder that is not empty and that becalm did not make.
void keep_foreign_files(const std::string& folder) {
  std::error_code error;
  const bool is_ours = !fs::exists(folder, error) || fs::is_empty(folder, error) ||
                       fs::exists(fs::path(folder) / kMarker, error);
  if (is_ours) return;
  throw Error(ExitStatus::usage,
              fmt::format("--keep: {} holds files of others; choose another folder", folder));
}

}  // namespace

WorkFolder::WorkFolder(const std::string& kept, const std::vector<TestCase>& cases)
    : is_temporary_(kept.empty()) {
  if (is_temporary_) {
    path_ = make_temporary_folder();
    return;
  }
  path_ = fs::absolute(kept).lexically_normal().string();
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) fail_to_make(path_, error);
  std::vector<std::string> names;
  for (const TestCase& test : cases) {
    const std::string folder = path_of(test);
    keep_foreign_files(folder);
    check_place("--keep", folder, folder + "/" + kMarker);
    names.push_back(test.full_name());
  }
  lock_.emplace(path_, names, "--keep");
}

WorkFolder::~WorkFolder() {
  std::error_code ignored;
  if (is_temporary_) fs::remove_all(path_, ignored);
}

std::string WorkFolder::path_of(const TestCase& test) const {
  return (fs::path(path_) / test.suite / test.name).string();
}

std::string WorkFolder::folder_of(const TestCase& test, const std::string& part) const {
  const std::string of_case = path_of(test);
  if (!is_temporary_) keep_foreign_files(of_case);
  std::string folder = part.empty() ? of_case : of_case + "/" + part;
  std::error_code error;
  fs::remove_all(folder, error);
  if (!error) fs::create_directories(folder, error);
  if (!error && !is_temporary_)
    std::ofstream(fs::path(of_case) / kMarker) << "Made by becalm test, and replaced by it.\n";
  if (error) fail_to_make(folder, error);
  return folder;
}

}  // namespace becalm::app
