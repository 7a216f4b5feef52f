#include "app/frame_sink.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/cancel.h"
#include "app/console.h"

namespace becalm::app {

FrameSink::FrameSink(const Outputs& outputs, const std::set<int>& existing, Progress& progress,
                     Profile& profile)
    : outputs_(outputs), existing_(existing), progress_(progress), profile_(profile) {}

bool FrameSink::wants(int number) {
  if (!existing_.contains(number)) return true;
  progress_.frame_kept(number);
  return false;
}

void FrameSink::write(
    int number, const std::function<io::WriteReport(const std::string& path, std::size_t file)>& write) {
  for (std::size_t file = 0; file < outputs_.files(); ++file) {
    const std::string path = outputs_.path(number, file);
    write_file(number, path, [&] { return write(path, file); });
  }
  progress_.frame_written(number);
}

void FrameSink::write_file(int number, const std::string& path,
                           const std::function<io::WriteReport()>& write) {
  io::WriteReport report;
  {
    const ProfileScope scope(profile_, "write");
    report = write();
  }
  if (report.half_overflows > 0) {
    progress_.warn(fmt::format(
        "frame {}: {} values beyond half's range were written as its largest; --type float keeps them",
        number, report.half_overflows));
  }
  if (report.lossless_instead) {
    warn_once("ZIP instead of the lossy compression, which would alter the channels passed on");
  }
  if (report.full_size_only) {
    warn_once("only the full size of mipmaps is written");
  }
  if (report.diagnostics_replace) {
    warn_once("diagnostics are written instead of the input's channels of the same names");
  }
  progress_.detail(fmt::format("frame {}: wrote {}", number, path));
}

void FrameSink::warn_once(const std::string& line) {
  if (said_.insert(line).second) progress_.warn(line);
}

void warn_unusable(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) warn(fmt::format("{} is damaged and is written again", path));
}

ExitStatus all_there(std::size_t frames, bool quiet) {
  if (quiet) return ExitStatus::done;
  say(frames == 1 ? "the frame is there already" : fmt::format("all {} frames are there already", frames));
  if (message_format() == MessageFormat::json) {
    say_event({{"event", "end"}, {"written", 0}, {"done", frames}, {"total", frames}});
  }
  return ExitStatus::done;
}

ExitStatus conclude(Progress& progress, std::size_t frames_asked, const Profile* profile) {
  const std::size_t written = progress.written();
  const bool cut_short = interrupted() && written < frames_asked;
  progress.finish(!cut_short);
  if (profile != nullptr) profile->print();
  if (!cut_short) return ExitStatus::done;
  say_interrupted(
      fmt::format("interrupted: {} of {} frames written; go on with --resume", written, frames_asked));
  return ExitStatus::interrupted;
}

}  // namespace becalm::app
