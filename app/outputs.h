#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "app/folder_lock.h"
#include "frame/io/exr.h"
#include "frame/io/sequence.h"

namespace becalm::app {

/// Whether the name ends in `.exr`, whatever the case.
bool is_exr_name(const std::string& name);

/// The attribute by which a file tells the command that wrote it.
inline constexpr const char* kCommandAttribute = "becalm:command";

/// Adds `becalm:frame`, the frame's number, to the attributes of a file whose content depends on it.
io::Attributes of_frame(io::Attributes attributes, int frame);

/// What tells the files of one command from others.
struct FileMark {
  std::string_view command;    ///< as files record it
  std::string_view attribute;  ///< that files of earlier versions have, which do not record the command
};

/// A file that the command did not write.
bool is_foreign(const std::string& path, const FileMark& mark);

/// The path with links resolved as far as it exists, so that equal text means the same file.
std::string resolved(const std::string& path);

/// Throws Error(resource) if the path's folder cannot be written to or made. Changes nothing. `option` and
/// `name` stand in the message.
void check_place(std::string_view option, std::string_view name, const std::string& path);

/// The files that a command writes: one a frame, or one for each eye.
class Outputs {
 public:
  /// Throws Error(usage) unless the patterns are EXR names, with a frame field if there are several frames
  /// and none in a folder that is not there. `option` is the patterns' name in messages.
  Outputs(std::string_view option, std::vector<io::SequencePattern> patterns, std::vector<int> frames);

  const std::vector<int>& frames() const { return frames_; }
  /// Files of a frame.
  std::size_t files() const { return patterns_.size(); }
  std::string path(int frame, std::size_t file = 0) const { return patterns_[file].path(frame); }
  /// Of all files of a frame.
  std::vector<std::string> paths(int frame) const;

  /// Throws Error(usage) if one of the outputs is one of the files, also through links; `what` they are.
  void keep_apart_from(const std::vector<std::string>& files, std::string_view what = "the input") const;

  /// Throws Error(usage) if there is a foreign file in an output's place.
  void keep_foreign_files(const FileMark& mark) const;

  /// check_place of all, and that none of them is a folder.
  void check_places() const;

  /// Makes the folder, locks the frames against other processes as long as this lives, and removes what
  /// killed runs left half-written of them. Throws Error(resource), before hours of work whose result could
  /// not be written, also for a folder in a frame's place.
  void prepare();

  /// An attribute of the first output that is there; empty if there is none.
  std::string recorded(const std::string& attribute) const;

  struct Existing {
    std::set<int> frames;               ///< all files there, whole, and written with the same attributes
    std::vector<std::string> unusable;  ///< there, but no longer readable: to be written again
  };
  /// What --resume keeps. Throws Error(usage) for a file that was written with other attributes than its
  /// frame's, naming what differs, and without `overwrite` for a foreign one.
  Existing find_existing(const std::function<io::Attributes(int frame)>& attributes, const FileMark& mark,
                         bool overwrite) const;

 private:
  std::vector<std::string> all_paths() const;
  /// Throws Error(resource) for a folder in an output's place.
  void refuse_folder(const std::string& path) const;
  [[noreturn]] void refuse_foreign_file(const std::string& path, const FileMark& mark) const;
  [[noreturn]] void refuse_attributes(const std::string& path, const std::string& difference) const;

  std::string option_;
  std::vector<io::SequencePattern> patterns_;
  std::vector<int> frames_;
  std::vector<std::unique_ptr<FolderLock>> locks_;  ///< of each folder
};

/// The frames up to the last one that is not among the existing ones: what a filter whose history is
/// unbounded must go through.
std::vector<int> up_to_last_missing(const std::vector<int>& frames, const std::set<int>& existing);

}  // namespace becalm::app
