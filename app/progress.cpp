#include "app/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
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
  frames_done_ = std::max(frames_done_, frames_done);
  if (made_s_ == 0.0 && frames_done_ >= static_cast<double>(options_.work)) made_s_ = elapsed_s();
  tell_work(frame);
}

void Progress::update_filter(int frame, std::size_t steps_done) {
  const std::lock_guard lock(mutex_);
  if (filter_begins_s_ == 0.0) filter_begins_s_ = elapsed_s();
  steps_done_ = steps_done;
  tell_work(frame);
}

void Progress::tell_work(int frame) {
  frame_ = frame;
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
  if (options_.steps == 0) frames_done_ = std::max(frames_done_, static_cast<double>(worked_));
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
  steps_done_ = options_.steps;
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
  if (options_.work == 0)  // nothing but the filter's
    return format_rate(static_cast<double>(steps_done_) / std::max(1e-6, elapsed_s()), "steps");
  const double seconds = options_.steps > 0 && made_s_ > 0.0 ? made_s_ : elapsed_s();
  return format_rate(frames_done_ * options_.units_per_frame / std::max(1e-6, seconds), options_.unit);
}

double Progress::share_done() const {
  const auto share = [](double done, std::size_t all) {
    return all == 0 ? 1.0 : std::clamp(done / static_cast<double>(all), 0.0, 1.0);
  };
  const double made = share(frames_done_, options_.work);
  if (options_.steps == 0) return made;
  const double filtered = share(static_cast<double>(steps_done_), options_.steps);
  return options_.work == 0 ? filtered : 0.5 * (made + filtered);
}

/// Infinite while nothing is known. A filter that has not begun does not count.
double Progress::seconds_left() const {
  const auto left = [](double seconds, double done, std::size_t all) {
    return seconds * std::max(0.0, static_cast<double>(all) - done) / done;
  };
  const bool is_made = frames_done_ >= static_cast<double>(options_.work);
  const double making = is_made ? 0.0 : left(elapsed_s(), frames_done_, options_.work);
  const double filter_s = elapsed_s() - filter_begins_s_;
  const auto steps = static_cast<double>(steps_done_);
  if (steps_done_ > 0) return std::max(making, left(filter_s, steps, options_.steps));
  return options_.steps > 0 && is_made ? std::numeric_limits<double>::infinity() : making;
}

std::string Progress::time_left() const {
  const double seconds = seconds_left();
  if (seconds <= 0.0 || !std::isfinite(seconds)) return "";
  return fmt::format(", {} left", format_duration(seconds));
}

nlohmann::ordered_json Progress::figures() const {
  nlohmann::ordered_json figures{{"done", options_.existing + written_},
                                 {"total", options_.total},
                                 {"work_done", frames_done_},
                                 {"work_total", options_.work},
                                 {"elapsed_s", elapsed_s()}};
  if (options_.steps > 0) {
    figures["filter_done"] = steps_done_;
    figures["filter_total"] = options_.steps;
  }
  if (const double seconds = seconds_left(); std::isfinite(seconds)) figures["left_s"] = seconds;
  return figures;
}

void Progress::draw() {
  const int filled = static_cast<int>(share_done() * kBarWidth);
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
