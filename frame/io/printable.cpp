#include "frame/io/printable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace becalm::io {
namespace {

/// Bytes of the printable UTF-8 sequence that `text` begins with, or 0.
std::size_t sequence_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7f && first != '\\' ? 1 : 0;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
  std::uint32_t code = first & (0xffu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3fu);
  }
  constexpr std::uint32_t shortest[] = {0, 0, 0xa0, 0x800, 0x10000};  // 0x80 to 0x9f are controls, too
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  return code >= shortest[length] && code <= 0x10ffff && !surrogate ? length : 0;
}

}  // namespace

std::string printable(std::string_view text, std::size_t most) {
  std::string result;
  while (!text.empty()) {
    if (result.size() >= most) return result + "...";
    const std::size_t length = sequence_length(text);
    if (length > 0) {
      result += text.substr(0, length);
    } else if (text.front() == '\\') {
      result += "\\\\";
    } else {
      result += fmt::format("\\x{:02x}", static_cast<unsigned char>(text.front()));
    }
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return result;
}

}  // namespace becalm::io
