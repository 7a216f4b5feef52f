#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace becalm::app {

/// The names of the files in each of their folders; an empty folder is the current one.
using NamesByFolder = std::map<std::filesystem::path, std::set<std::string>>;
NamesByFolder by_folder(const std::vector<std::string>& paths);

/// Removes what killed runs left half-written of these files, `NAME.partial.PID.N` of io::AtomicFile. Call it
/// before this process writes any of them. A folder that cannot be listed is left as it is.
void remove_abandoned_partials(const std::filesystem::path& folder, const std::set<std::string>& names);
void remove_abandoned_partials(const std::vector<std::string>& paths);

}  // namespace becalm::app
