#pragma once

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace becalm {

/// The names of what a folder holds, in no order; an empty path is the current folder. Where it cannot be
/// read, or not to its end, `error` says why, and the names before are returned. Incrementing an iterator of
/// a range-based for would throw then.
inline std::vector<std::string> names_in(const std::filesystem::path& folder, std::error_code& error) {
  namespace fs = std::filesystem;
  std::vector<std::string> names;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, error), end; !error && entry != end;
       entry.increment(error))
    names.push_back(entry->path().filename().string());
  return names;
}

}  // namespace becalm
