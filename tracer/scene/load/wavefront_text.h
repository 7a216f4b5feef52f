#pragma once

#include <optional>
#include <string>

namespace becalm::tracer {

/// The text of an OBJ or MTL file, one statement a line: without a byte order mark, and lines that end in a
/// backslash joined with their next, unless they have a comment. As many empty lines follow the joined one,
/// so that line numbers stay those of the file. Nothing if the file cannot be read; throws
/// Error(bad_input) for what is no file.
std::optional<std::string> read_wavefront_text(const std::string& path);

}  // namespace becalm::tracer
