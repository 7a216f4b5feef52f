#include "app/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "app/console.h"
#include "app/counted.h"

namespace becalm::app {
namespace {

constexpr std::chrono::milliseconds kRedrawEvery{100};
constexpr std::chrono::seconds kReportEvery{1};  ///< in JSON
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

Progress::Progress(const ProgressOptions& options)
    : options_(options), terminal_(message_format() == MessageFormat::text && is_terminal()) {}

Progress::~Progress() {
  const std::lock_guard lock(mutex_);
  erase();
}

void Progress::update(int frame, double frames_done) {
  const std::lock_guard lock(mutex_);
  frame_ = frame;
  frames_done_ = std::max(frames_done_, frames_done);
  if (options_.quiet) return;
  if (message_format() == MessageFormat::json && Clock::now() - drawn_ >= kReportEvery) {
    nlohmann::ordered_json event{{"event", "progress"}, {"frame", frame}};
    event.update(figures());
    say_event(event);
    drawn_ = Clock::now();
  }
  if (terminal_ && Clock::now() - drawn_ >= kRedrawEvery) draw();
  const bool is_plain = !terminal_ && message_format() == MessageFormat::text;
  if (is_plain && Clock::now() - said_ >= options_.say_every) say_figures(frame, "at work");
}

void Progress::frame_kept(int frame) {
  const std::lock_guard lock(mutex_);
  frame_done(frame, "kept");
}

void Progress::frame_written(int frame) {
  const std::lock_guard lock(mutex_);
  ++written_;
  frame_done(frame, "written");
}

void Progress::frame_done(int frame, std::string_view state) {
  ++worked_;
  frames_done_ = std::max(frames_done_, static_cast<double>(worked_));
  if (options_.quiet) return;
  if (terminal_) {
    draw();
    return;
  }
  if (message_format() == MessageFormat::json) {
    nlohmann::ordered_json event{{"event", "frame"}, {"frame", frame}, {"state", state}};
    event.update(figures());
    say_event(event);
    return;
  }
  say_figures(frame, state == "written" ? state : "exists, gone through for the history");
}

void Progress::say_figures(int frame, std::string_view state) {
  say(fmt::format("frame {}: {}, {} of {} done, {}{}", frame, state, options_.existing + written_,
                  options_.total, rate(), time_left()));
  said_ = Clock::now();
}

void Progress::warn(std::string_view line) {
  const std::lock_guard lock(mutex_);
  const bool redraw = line_shown_;
  erase();
  app::warn(line);
  if (redraw) draw();
}

void Progress::note(std::string_view line) {
  if (!options_.quiet) warn(line);
}

void Progress::detail(std::string_view line) {
  if (options_.verbose) warn(line);
}

void Progress::finish(bool done) {
  const std::lock_guard lock(mutex_);
  erase();
  if (options_.quiet || !done) return;
  if (message_format() == MessageFormat::json) {
    nlohmann::ordered_json event{{"event", "end"}, {"written", written_}};
    event.update(figures());
    say_event(event);
    return;
  }
  say(fmt::format("{} written in {}, {}{}", counted(written_, "frame", "frames"),
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

double Progress::seconds_left() const {
  return elapsed_s() * std::max(0.0, static_cast<double>(options_.work) - frames_done_) / frames_done_;
}

std::string Progress::time_left() const {
  if (frames_done_ <= 0.0 || frames_done_ >= static_cast<double>(options_.work)) return "";
  return fmt::format(", {} left", format_duration(seconds_left()));
}

nlohmann::ordered_json Progress::figures() const {
  nlohmann::ordered_json figures{{"done", options_.existing + written_},
                                 {"total", options_.total},
                                 {"work_done", frames_done_},
                                 {"work_total", options_.work},
                                 {"elapsed_s", elapsed_s()}};
  if (frames_done_ > 0.0) figures["left_s"] = seconds_left();
  return figures;
}

void Progress::draw() {
  const double share = std::clamp(frames_done_ / static_cast<double>(options_.work), 0.0, 1.0);
  const int filled = static_cast<int>(share * kBarWidth);
  std::string line =
      fmt::format("[{:#<{}}{:.<{}}] {} of {}, frame {}, {}{}", "", filled, "", kBarWidth - filled,
                  options_.existing + written_, options_.total, frame_, rate(), time_left());
  line.resize(std::min(line.size(), terminal_columns() - 1));  // a wrapped line could not be drawn over
  write_error(fmt::format("\r{}\x1b[K", line));
  drawn_ = Clock::now();
  line_shown_ = true;
}

void Progress::erase() {
  if (!line_shown_) return;
  write_error("\r\x1b[K");
  line_shown_ = false;
}

}  // namespace becalm::app
