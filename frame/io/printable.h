#pragma once

#include <string>
#include <string_view>

namespace becalm::io {

/// Text from a file, made safe for a terminal: control characters and bytes that are not UTF-8 become escapes
/// such as `\x1b`, a backslash is doubled, and after about `most` characters the rest is cut to `...`.
std::string printable(std::string_view text, std::size_t most = 100);

}  // namespace becalm::io
