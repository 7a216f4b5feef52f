#pragma once

#include <charconv>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>

namespace becalm::app {

/// Reads exactly `numbers.size()` numbers with `separator` between them. False for another text.
template <class Number>
bool parse_numbers(std::string_view text, char separator, std::span<Number> numbers) {
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

/// The one number that the text is, which may have a sign; nothing for another text.
template <class Number>
std::optional<Number> parse_number(std::string_view text) {
  Number number{};
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  if (!parse_numbers(text, ',', std::span(&number, 1))) return std::nullopt;
  return number;
}

}  // namespace becalm::app
