#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/test/make_frames.h"
#include "app/test/suite.h"
#include "frame/error.h"

namespace becalm::app {

/// The case's reference files, whether they are there or not.
std::vector<std::string> reference_files(const TestCase& test);

/// Those that are not there.
std::vector<std::string> missing_references(const TestCase& test);

/// Throws Error(bad_input) for a reference file that is no EXR or is not whole.
void check_references(const TestCase& test);

/// Samples per pixel that a reference file was made with; 1 where it does not tell.
double samples_of_reference(const std::string& path);

/// One case of --update: new references are made beside the work, compared with the old ones, and replace
/// them when `accept` is called.
class ReferenceUpdate {
 public:
  ReferenceUpdate(const TestCase& test, const RunSettings& settings);

  /// Makes the new ones. Throws Error(bad_input) if that fails, and Error(interrupted); both name the case.
  void make();
  /// One line a frame: its size, and how far it is from the one before; and one for each file to remove.
  const std::vector<std::string>& changes() const { return changes_; }
  /// All new references together.
  std::uint64_t bytes() const { return bytes_; }
  /// Puts them in their place, all or none: throws Error(resource) before the first if one cannot be written.
  void accept() const;

 private:
  void make_one(int which);
  void find_outdated();
  std::string message_of(const Error& error) const;
  std::string change_of(int frame, const std::string& old_file, const std::string& new_file) const;

  const TestCase& test_;
  const RunSettings& settings_;
  std::vector<std::pair<std::string, std::string>> files_;  ///< made, and its place
  std::vector<std::string> outdated_;  ///< of frames that the case does not have any more
  std::vector<std::string> changes_;
  std::uint64_t bytes_ = 0;
};

}  // namespace becalm::app
