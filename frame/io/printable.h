#pragma once

#include <string>
#include <string_view>

namespace becalm::io {

/// Text out of a file as it may go to a terminal: control characters and what is not UTF-8 as `\x1b`, a
/// backslash twice, and `...` after `most` characters of output or a few more.
std::string printable(std::string_view text, std::size_t most = 100);

}  // namespace becalm::io
