#include "app/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "app/console.h"
#include "app/counted.h"

namespace becalm::app {
namespace {

constexpr std::chrono::milliseconds kRedrawEvery{100};
constexpr int kBarWidth = 24;

/// A terminal that understands carriage return and erase-to-end.
bool is_terminal() {
  const char* term = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && term != nullptr && std::string_view(term) != "dumb";
}

std::size_t terminal_columns() {
  winsize size = {};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

std::string format_rate(double per_second, const std::string& unit) {
  if (per_second >= 1e6) return fmt::format("{:.2f} M{}/s", per_second * 1e-6, unit);
  if (per_second >= 1e3) return fmt::format("{:.1f} k{}/s", per_second * 1e-3, unit);
  return fmt::format("{:.2f} {}/s", per_second, unit);
}

}  // namespace

std::string format_duration(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(std::max(0.0, seconds)));
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

Progress::Progress(const ProgressOptions& options) : options_(options), terminal_(is_terminal()) {}

Progress::~Progress() {
  const std::lock_guard lock(mutex_);
  erase();
}

void Progress::update(int frame, double frames_done) {
  const std::lock_guard lock(mutex_);
  frame_ = frame;
  frames_done_ = std::max(frames_done_, frames_done);
  if (options_.quiet || !terminal_ || Clock::now() - drawn_ < kRedrawEvery) return;
  draw();
}

void Progress::frame_kept(int frame) {
  const std::lock_guard lock(mutex_);
  frame_done(frame, "exists, gone through for the history");
}

void Progress::frame_written(int frame) {
  const std::lock_guard lock(mutex_);
  ++written_;
  frame_done(frame, "written");
}

void Progress::frame_done(int frame, std::string_view what) {
  ++worked_;
  frames_done_ = std::max(frames_done_, static_cast<double>(worked_));
  if (options_.quiet) return;
  if (terminal_) {
    draw();
    return;
  }
  say(fmt::format("frame {}: {}, {} of {} done, {}{}\n", frame, what, options_.existing + written_,
                  options_.total, rate(), time_left()));
}

void Progress::warn(std::string_view line) {
  const std::lock_guard lock(mutex_);
  const bool redraw = line_shown_;
  erase();
  say(fmt::format("becalm: {}\n", line));
  if (redraw) draw();
}

void Progress::note(std::string_view line) {
  if (!options_.quiet) warn(line);
}

void Progress::finish(bool done) {
  const std::lock_guard lock(mutex_);
  erase();
  if (options_.quiet || !done) return;
  say(fmt::format("{} written in {}, {}{}\n", counted(written_, "frame", "frames"),
                  format_duration(elapsed_s()), rate(),
                  options_.existing > 0 ? fmt::format("; {} were there already", options_.existing) : ""));
}

std::size_t Progress::written() const {
  const std::lock_guard lock(mutex_);
  return options_.existing + written_;
}

double Progress::elapsed_s() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

std::string Progress::rate() const {
  return format_rate(frames_done_ * options_.units_per_frame / std::max(1e-6, elapsed_s()), options_.unit);
}

std::string Progress::time_left() const {
  const double left = static_cast<double>(options_.work) - frames_done_;
  if (frames_done_ <= 0.0 || left <= 0.0) return "";
  return fmt::format(", {} left", format_duration(elapsed_s() * left / frames_done_));
}

void Progress::draw() {
  const double share = std::clamp(frames_done_ / static_cast<double>(options_.work), 0.0, 1.0);
  const int filled = static_cast<int>(share * kBarWidth);
  std::string line =
      fmt::format("[{:#<{}}{:.<{}}] {} of {}, frame {}, {}{}", "", filled, "", kBarWidth - filled,
                  options_.existing + written_, options_.total, frame_, rate(), time_left());
  line.resize(std::min(line.size(), terminal_columns() - 1));  // a wrapped line could not be drawn over
  say(fmt::format("\r{}\x1b[K", line));
  drawn_ = Clock::now();
  line_shown_ = true;
}

void Progress::erase() {
  if (!line_shown_) return;
  say("\r\x1b[K");
  line_shown_ = false;
}

}  // namespace becalm::app
