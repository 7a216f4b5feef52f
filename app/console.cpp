#include "app/console.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/cancel.h"
#include "frame/io/printable.h"

namespace becalm::app {

namespace {

MessageFormat chosen_format = MessageFormat::text;

void say_behind(std::string_view prefix, std::string_view line) {
  if (chosen_format == MessageFormat::json) {
    say_event({{"event", "message"}, {"text", line}});
  } else {
    write_error(fmt::format("{}{}\n", prefix, line));
  }
}

}  // namespace

void set_message_format(MessageFormat format) {
  chosen_format = format;
}
MessageFormat message_format() {
  return chosen_format;
}

void write_error(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void say(std::string_view line) {
  say_behind("", line);
}

void say_event(const nlohmann::ordered_json& event) {
  write_error(event.dump(-1, ' ', /*ensure_ascii=*/false, nlohmann::json::error_handler_t::replace) + '\n');
}

void warn(std::string_view line) {
  say_behind("becalm: ", line);
}

void warn_each(std::span<const std::string> lines) {
  constexpr std::size_t most = 20, longest = 1000;
  for (const std::string& line : lines.first(std::min(most, lines.size())))
    warn(io::printable(line, longest));
  if (lines.size() > most) warn(fmt::format("{} more such lines are left out", lines.size() - most));
}

void say_error(ExitStatus status, std::string line) {
  std::ranges::replace_if(
      line, [](unsigned char c) { return c < ' ' || c == 0x7f; }, ' ');
  if (chosen_format == MessageFormat::json) {
    say_event({{"event", "error"}, {"status", process_status(status)}, {"text", line}});
  } else {
    warn("error: " + line);
  }
}

void say_interrupted(const std::string& line) {
  if (chosen_format == MessageFormat::json) {
    say_error(ExitStatus::interrupted, line);
  } else {
    say(line);
  }
}

void occupy_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    // open() takes the lowest free number, which is the stream's. Read-only: what is printed to a closed
    // standard output is lost, and has to be noticed.
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF) ::open("/dev/null", O_RDONLY);
  }
}

}  // namespace becalm::app
