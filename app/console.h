#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>

#include "frame/error.h"

namespace becalm::app {

/// How standard error speaks: to people, or one JSON object a line to a farm's manager.
enum class MessageFormat { text, json };

/// For the whole process; text unless set.
void set_message_format(MessageFormat format);
MessageFormat message_format();

/// Writes to standard error. A failure is ignored: a run does not end because a message is lost.
void write_error(std::string_view text);
/// A line of text, or {"event": "message", "text": LINE}.
void say(std::string_view line);
/// One object as a line, whatever the format.
void say_event(const nlohmann::ordered_json& event);
/// A line behind `becalm: `, or the same object as `say`.
void warn(std::string_view line);
/// Warnings about files: each made safe for a terminal; of many the first ones, and how many more.
void warn_each(std::span<const std::string> lines);

/// One line of what went wrong, with control characters as blanks, behind `becalm: error: `; or {"event":
/// "error", "status": STATUS, "text": LINE}.
void say_error(ExitStatus status, std::string line);

/// The last line of a run that a signal ended: text, or the event of an error.
void say_interrupted(const std::string& line);

/// Opens /dev/null in place of standard streams that the process was started without. Otherwise the next file
/// that is opened would take the number of such a stream, and messages would be written into a frame.
void occupy_closed_streams();

}  // namespace becalm::app
