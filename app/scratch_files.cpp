#include "app/scratch_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "app/eye_names.h"
#include "frame/io/sequence.h"
#include "frame/names_in.h"

namespace becalm::app {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kScratch = ".becalm-scratch-";

/// The output's pattern up to its ending.
std::string base_of(std::string output, Eye first) {
  if (has_eye_field(output)) output = pattern_of_eye(output, first == Eye::right ? 1 : 0);
  return output.substr(0, output.rfind('.'));
}

/// The first and last frame that `NAME.becalm-scratch-FIRST-LAST...` was asked for.
std::optional<std::pair<int, int>> asked_of(std::string_view name) {
  name.remove_prefix(std::min(name.size(), name.find(kScratch) + kScratch.size()));
  std::pair<int, int> asked;
  const auto first = std::from_chars(name.data(), name.data() + name.size(), asked.first);
  if (first.ec != std::errc() || first.ptr == name.data() + name.size() || *first.ptr != '-') return {};
  const auto last = std::from_chars(first.ptr + 1, name.data() + name.size(), asked.second);
  return last.ec == std::errc() ? std::optional(asked) : std::nullopt;
}

}  // namespace

std::string noisy_pattern(const std::string& keep_noisy, const std::string& output, Eye first,
                          const std::vector<int>& asked) {
  if (!keep_noisy.empty()) return keep_noisy;
  const std::string base = base_of(output, first);
  const bool has_field = io::SequencePattern(base).has_frame_field();
  return fmt::format("{}{}{}-{}{}.exr", base, kScratch, std::ranges::min(asked), std::ranges::max(asked),
                     has_field ? "" : ".####");
}

std::optional<std::string> remove_scratch_file(const std::string& path) {
  std::error_code error;
  fs::remove(path, error);
  if (!error) return std::nullopt;
  return fmt::format("{}: cannot be removed, and is not needed any more: {}", path, error.message());
}

void remove_abandoned_scratch(const std::string& output, Eye first, const Outputs& locked,
                              const std::vector<int>& readable) {
  const io::SequencePattern base(base_of(output, first));
  std::set<std::string> names;
  for (const int frame : readable) names.insert(fs::path(base.path(frame)).filename().string());
  const fs::path folder = fs::path(base.text()).parent_path();
  const std::set<int> ours(locked.frames().begin(), locked.frames().end());
  std::error_code error;
  for (const std::string& name : names_in(folder, error)) {
    const auto at = name.find(kScratch);
    if (at == std::string::npos || !names.contains(name.substr(0, at))) continue;
    const auto asked = asked_of(name);
    if (!asked || *asked == std::pair(*ours.begin(), *ours.rbegin())) continue;
    if (ours.contains(asked->first) || ours.contains(asked->second)) fs::remove(folder / name, error);
  }
}

}  // namespace becalm::app
