#pragma once

#include <charconv>
#include <span>
#include <string_view>
#include <system_error>

namespace becalm::app {

/// Reads exactly `numbers.size()` integers with `separator` between them. False for another text.
template <class Integer>
bool parse_numbers(std::string_view text, char separator, std::span<Integer> numbers) {
  const char* position = text.data();
  const char* end = text.data() + text.size();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0 && (position == end || *position++ != separator)) return false;
    const auto parsed = std::from_chars(position, end, numbers[i]);
    if (parsed.ec != std::errc()) return false;
    position = parsed.ptr;
  }
  return position == end;
}

}  // namespace becalm::app
