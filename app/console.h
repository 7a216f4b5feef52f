#pragma once

#include <string_view>

namespace becalm::app {

/// Writes to standard error. A failure is ignored: a message that nobody can read is not worth a frame.
void say(std::string_view text);

/// Opens /dev/null in place of standard streams that the process was started without. Otherwise the next file
/// that is opened would take the number of such a stream, and messages would be written into a frame.
void occupy_closed_streams();

}  // namespace becalm::app
