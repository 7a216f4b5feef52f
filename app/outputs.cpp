#include "app/outputs.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <system_error>

#include "app/cancel.h"
#include "app/partial_files.h"
#include "app/setting_text.h"
#include "frame/error.h"
#include "frame/io/atomic_file.h"
#include "frame/io/exr_channels.h"

namespace becalm::app {
namespace fs = std::filesystem;

namespace {

/// The first setting that differs, as `spp=4, and this run has spp=8`.
std::string describe_difference(const std::string& there, const std::string& here) {
  const auto old_settings = parse_settings(there);
  const auto new_settings = parse_settings(here);
  const auto find = [](const auto& settings, const std::string& key) {
    return std::ranges::find(settings, key, [](const auto& setting) { return setting.first; });
  };
  for (const auto& [key, value] : new_settings) {
    const auto found = find(old_settings, key);
    if (found == old_settings.end()) return fmt::format("no {}, and this run has {}={}", key, key, value);
    if (found->second == value) continue;
    if (key == "scene") return "another content of the scene or of a file that it names";
    return fmt::format("{}={}, and this run has {}={}", key, found->second, key, value);
  }
  for (const auto& [key, value] : old_settings) {
    if (find(new_settings, key) == new_settings.end()) {
      return fmt::format("{}={}, and this run has none", key, value);
    }
  }
  return "the settings in another order";
}

bool is_whole(const std::string& path) {
  try {
    io::require_whole_exr(path);
    return true;
  } catch (const Error& error) {
    if (error.status() == ExitStatus::resource) throw;
    return false;
  }
}

/// The text attributes of an EXR file that becalm wrote.
using Recorded = std::map<std::string, std::string>;

/// Nothing where no file is, and an empty record of one that becalm did not write.
std::optional<Recorded> recorded_in(const std::string& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  try {
    Recorded recorded = io::read_attributes(path);
    return recorded["becalm:version"].empty() ? Recorded() : recorded;
  } catch (const Error& failure) {
    if (failure.status() == ExitStatus::resource) throw;
    return Recorded();
  }
}

std::string value_of(const Recorded& recorded, std::string_view attribute) {
  const auto found = recorded.find(std::string(attribute));
  return found == recorded.end() ? std::string() : found->second;
}

/// The first of the attributes that the record has with another value, in words; empty if there is none.
std::string describe_difference(const Recorded& recorded, const io::Attributes& attributes) {
  for (const auto& [name, value] : attributes) {
    if (name == kCommandAttribute) continue;  // is_foreign has looked at it
    const std::string found = value_of(recorded, name);
    if (found == value) continue;
    if (found.empty()) return fmt::format("no {}, so becalm did not write it with such a command", name);
    if (value.find('=') == std::string::npos) {
      return fmt::format("{} {}, and this run has {}", name, found, value);
    }
    return describe_difference(found, value);
  }
  return {};
}

bool is_foreign(const std::optional<Recorded>& recorded, const FileMark& mark) {
  if (!recorded) return false;
  const std::string command = value_of(*recorded, kCommandAttribute);
  return command.empty() ? value_of(*recorded, mark.attribute).empty() : command != mark.command;
}

[[noreturn]] void refuse_place(std::string_view option, std::string_view name, const std::error_code& why) {
  throw Error(ExitStatus::resource,
              fmt::format("{} {}: cannot write there: {}", option, name, why.message()));
}

/// Throws Error(resource) where `folder`, which is there, can hold no partial file of this name.
void refuse_long_name(std::string_view option, const std::string& name, const fs::path& folder) {
  const long longest = ::pathconf(folder.c_str(), _PC_NAME_MAX);  // below 0: not known
  if (longest < 0 || name.size() + io::kLongestPartialSuffix <= static_cast<std::size_t>(longest)) return;
  refuse_place(option, name, std::make_error_code(std::errc::filename_too_long));
}

}  // namespace

io::Attributes of_frame(io::Attributes attributes, int frame) {
  attributes.emplace_back("becalm:frame", std::to_string(frame));
  return attributes;
}

bool is_exr_name(const std::string& name) {
  std::string extension = fs::path(name).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".exr";
}

std::string resolved(const std::string& path) {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(fs::absolute(path), error);
  return error ? path : canonical.string();
}

void check_place(std::string_view option, std::string_view name, const std::string& path) {
  fs::path place = fs::absolute(path).parent_path();
  std::error_code error;
  while (!fs::exists(place, error) && place.has_relative_path()) place = place.parent_path();
  if (!fs::is_directory(place, error))
    refuse_place(option, name, std::make_error_code(std::errc::not_a_directory));
  if (::access(place.c_str(), W_OK | X_OK) != 0) refuse_place(option, name, {errno, std::generic_category()});
  refuse_long_name(option, fs::path(path).filename().string(), place);
}

bool is_foreign(const std::string& path, const FileMark& mark) {
  return is_foreign(recorded_in(path), mark);
}

Outputs::Outputs(std::string_view option, std::vector<io::SequencePattern> patterns, std::vector<int> frames)
    : option_(option), patterns_(std::move(patterns)), frames_(std::move(frames)) {
  for (const io::SequencePattern& pattern : patterns_) {
    if (!is_exr_name(pattern.text())) {
      throw Error(ExitStatus::usage,
                  fmt::format("{} {}: expected a file name that ends in .exr", option_, pattern.text()));
    }
    if (const std::string field = io::field_of_folder(pattern.text()); !field.empty()) {
      throw Error(ExitStatus::usage,
                  fmt::format("{} {}: the frame field '{}' is in a folder's name, expected it in the file's",
                              option_, pattern.text(), field));
    }
    if (frames_.size() > 1 && !pattern.has_frame_field()) {
      throw Error(ExitStatus::usage, fmt::format("{} {}: {} frames need a frame field, such as ####.exr",
                                                 option_, pattern.text(), frames_.size()));
    }
  }
}

std::vector<std::string> Outputs::paths(int frame) const {
  std::vector<std::string> paths;
  for (const io::SequencePattern& pattern : patterns_) paths.push_back(pattern.path(frame));
  return paths;
}

std::vector<std::string> Outputs::all_paths() const {
  std::vector<std::string> all;
  for (const int frame : frames_) std::ranges::move(paths(frame), std::back_inserter(all));
  return all;
}

void Outputs::keep_apart_from(const std::vector<std::string>& files, std::string_view what) const {
  std::set<std::string> taken;
  for (const std::string& file : files) taken.insert(resolved(file));
  for (const std::string& path : all_paths()) {
    if (!taken.contains(resolved(path))) continue;
    throw Error(ExitStatus::usage,
                fmt::format("{} {}: would overwrite {}; choose another name", option_, path, what));
  }
}

void Outputs::keep_foreign_files(const FileMark& mark) const {
  for (const std::string& path : all_paths()) {
    if (is_foreign(path, mark)) refuse_foreign_file(path, mark);
  }
}

void Outputs::refuse_foreign_file(const std::string& path, const FileMark& mark) const {
  throw Error(ExitStatus::usage,
              fmt::format("{} {}: is there, and becalm {} did not write it; --overwrite replaces it", option_,
                          path, mark.command));
}

void Outputs::check_places() const {
  for (const std::string& path : all_paths()) {
    check_place(option_, patterns_.front().text(), path);
    refuse_folder(path);
  }
}

void Outputs::refuse_folder(const std::string& path) const {
  std::error_code error;
  if (fs::is_directory(path, error))
    refuse_place(option_, path, std::make_error_code(std::errc::is_a_directory));
}

void Outputs::prepare() {
  const std::vector<std::string> paths = all_paths();
  for (const std::string& path : paths) refuse_folder(path);
  for (const auto& [folder, files] : by_folder(paths)) {
    std::error_code error;
    if (!folder.empty()) fs::create_directories(folder, error);
    const fs::path place = folder.empty() ? fs::path(".") : folder;
    if (!error && ::access(place.c_str(), W_OK | X_OK) != 0) error = {errno, std::generic_category()};
    if (!error && !fs::is_directory(place)) error = std::make_error_code(std::errc::not_a_directory);
    if (error) refuse_place(option_, patterns_.front().text(), error);
    for (const std::string& file : files) refuse_long_name(option_, file, place);
    locks_.push_back(
        std::make_unique<FolderLock>(place, std::vector<std::string>(files.begin(), files.end()), option_));
    remove_abandoned_partials(place, files);
  }
}

std::string Outputs::recorded(const std::string& attribute) const {
  for (const std::string& path : all_paths()) {
    const std::optional<Recorded> recorded = recorded_in(path);
    if (recorded && !recorded->empty()) return value_of(*recorded, attribute);
  }
  return {};
}

Outputs::Existing Outputs::find_existing(const std::function<io::Attributes(int)>& attributes,
                                         const FileMark& mark, bool overwrite) const {
  const std::vector<std::string> all = all_paths();
  std::vector<char> is_usable(all.size(), 0);
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    stop_if_asked();
    std::error_code error;
    is_usable[i] = fs::exists(all[i], error) && is_whole(all[i]) ? 1 : 0;
  });
  Existing existing;
  auto usable = is_usable.begin();  // in the order of all_paths
  for (const int frame : frames_) {
    bool all_there = true;
    for (const std::string& path : paths(frame)) {
      std::error_code error;
      const std::optional<Recorded> recorded = recorded_in(path);
      const bool foreign = is_foreign(recorded, mark) && !fs::is_empty(path, error);
      if (foreign && !overwrite) refuse_foreign_file(path, mark);
      const bool is_kept = *usable != 0 && recorded && !foreign;
      if (is_kept) {
        const std::string difference = describe_difference(*recorded, attributes(frame));
        if (!difference.empty()) refuse_attributes(path, difference);
      }
      if (fs::exists(path, error) && !is_kept && !foreign) existing.unusable.push_back(path);
      all_there = all_there && is_kept;
      ++usable;
    }
    if (all_there) existing.frames.insert(frame);
  }
  return existing;
}

void Outputs::refuse_attributes(const std::string& path, const std::string& difference) const {
  throw Error(ExitStatus::usage,
              fmt::format("--resume: {} was written with {}; use the same options or another {}", path,
                          difference, option_));
}

std::vector<int> up_to_last_missing(const std::vector<int>& frames, const std::set<int>& existing) {
  const auto last =
      std::find_if(frames.rbegin(), frames.rend(), [&](int frame) { return !existing.contains(frame); });
  return {frames.begin(), last.base()};
}

}  // namespace becalm::app
