#pragma once

#include <string>

namespace becalm::app {

/// Writes a report that an option asked for. A regular file appears or is replaced whole (io::AtomicFile),
/// and its folder is made; `/dev/stdout` is standard output, and other devices and pipes are written to.
/// Throws Error(resource) naming the option.
void write_report_file(const std::string& option, const std::string& path, const std::string& text);

}  // namespace becalm::app
