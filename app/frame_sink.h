#pragma once

#include <cstddef>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "app/outputs.h"
#include "app/profile.h"
#include "app/progress.h"
#include "frame/error.h"
#include "frame/io/exr.h"

namespace becalm::app {

/// The end of the pipeline: frames become files, and the user hears of it.
class FrameSink {
 public:
  /// `existing` are outputs that stay.
  FrameSink(const Outputs& outputs, const std::set<int>& existing, Progress& progress, Profile& profile);

  /// Whether this output is to be written. One that exists counts as done.
  bool wants(int number);
  /// Runs `write` for the path of each of the output's files and says what became of it.
  void write(int number,
             const std::function<io::WriteReport(const std::string& path, std::size_t file)>& write);

 private:
  void write_file(int number, const std::string& path, const std::function<io::WriteReport()>& write);
  /// For what is the same with every frame that is written.
  void warn_once(const std::string& line);

  const Outputs& outputs_;
  const std::set<int>& existing_;
  Progress& progress_;
  Profile& profile_;
  std::set<std::string> said_;
};

/// One line for each file that --resume found damaged and that is therefore written again.
void warn_unusable(const std::vector<std::string>& paths);

/// --resume with nothing left to do.
ExitStatus all_there(std::size_t frames, bool quiet);

/// The last words of a command that writes frames, and its status: done, or interrupted and how to go on.
ExitStatus conclude(Progress& progress, std::size_t frames_asked, const Profile* profile);

}  // namespace becalm::app
