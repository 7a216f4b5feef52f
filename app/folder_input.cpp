#include "app/folder_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "app/outputs.h"
#include "frame/error.h"
#include "frame/io/sequence.h"
#include "frame/names_in.h"

namespace becalm::app {
namespace fs = std::filesystem;

namespace {

/// Patterns and single files, each in quotes.
std::vector<std::string> sequences_in(const std::string& folder) {
  std::vector<std::string> paths;
  std::error_code unreadable;
  for (const std::string& name : names_in(folder, unreadable)) {
    if (is_exr_name(name)) paths.push_back((fs::path(folder) / name).string());
  }
  std::vector<std::string> sequences = io::patterns_of_files(paths);
  for (std::string& sequence : sequences) sequence.insert(0, "'").append("'");
  return sequences;
}

}  // namespace

void refuse_folder(const std::string& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return;
  constexpr std::size_t most = 5;
  std::vector<std::string> sequences = sequences_in(path);
  if (sequences.empty()) throw Error(ExitStatus::usage, path + ": a folder, without EXR files in it");
  const std::size_t more = sequences.size() - std::min(most, sequences.size());
  sequences.resize(sequences.size() - more);
  throw Error(ExitStatus::usage,
              fmt::format("{}: a folder; name a sequence in it: {}{}", path, fmt::join(sequences, " or "),
                          more > 0 ? fmt::format(" or {} more", more) : ""));
}

}  // namespace becalm::app
