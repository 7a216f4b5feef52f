#include "app/writing.h"

#include <fmt/format.h>

#include "app/cancel.h"
#include "app/console.h"

namespace becalm::app {

void warn_overflows(Progress& progress, int frame, const io::WriteReport& report, std::string_view remedy) {
  if (report.half_overflows == 0) return;
  progress.warn(fmt::format("frame {}: {} values beyond half's range were written as its largest; {}", frame,
                            report.half_overflows, remedy));
}

void warn_unusable(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) warn(fmt::format("{} is damaged and is written again", path));
}

ExitStatus all_there(std::size_t frames, bool quiet) {
  if (!quiet)
    say(frames == 1 ? "the frame is there already" : fmt::format("all {} frames are there already", frames));
  return ExitStatus::done;
}

ExitStatus conclude(Progress& progress, std::size_t frames_asked, const Profile* profile) {
  const std::size_t written = progress.written();
  const bool cut_short = interrupted() && written < frames_asked;
  progress.finish(!cut_short);
  if (profile != nullptr) profile->print();
  if (!cut_short) return ExitStatus::done;
  say(fmt::format("interrupted: {} of {} frames written; go on with --resume", written, frames_asked));
  return ExitStatus::interrupted;
}

}  // namespace becalm::app
