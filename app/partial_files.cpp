#include "app/partial_files.h"

#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <string_view>
#include <system_error>

#include "frame/names_in.h"

namespace becalm::app {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kPartialMark = ".partial.";

/// The process that a partial file of one of these names tells, or 0 if it is another file.
int partial_owner(const std::string& file, const std::set<std::string>& names) {
  const auto mark = file.rfind(kPartialMark);
  if (mark == std::string::npos || !names.contains(file.substr(0, mark))) return 0;
  const char* begin = file.data() + mark + kPartialMark.size();
  const char* end = file.data() + file.size();
  int process = 0;
  unsigned counter = 0;
  const auto first = std::from_chars(begin, end, process);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != '.') return 0;
  const auto second = std::from_chars(first.ptr + 1, end, counter);
  return second.ec == std::errc() && second.ptr == end ? process : 0;
}

bool process_runs(int process) {
  return ::kill(process, 0) == 0 || errno != ESRCH;
}

}  // namespace

NamesByFolder by_folder(const std::vector<std::string>& paths) {
  NamesByFolder names;
  for (const std::string& path : paths)
    names[fs::path(path).parent_path()].insert(fs::path(path).filename().string());
  return names;
}

void remove_abandoned_partials(const fs::path& folder, const std::set<std::string>& names) {
  std::error_code error;
  for (const std::string& name : names_in(folder, error)) {
    const int owner = partial_owner(name, names);
    // Nothing of this process is half written yet: a file of its number is a dead process's, as a container
    // gives each run the same number.
    std::error_code ignored;
    if (owner == ::getpid() || (owner > 0 && !process_runs(owner))) fs::remove(folder / name, ignored);
  }
}

void remove_abandoned_partials(const std::vector<std::string>& paths) {
  for (const auto& [folder, names] : by_folder(paths)) remove_abandoned_partials(folder, names);
}

}  // namespace becalm::app
