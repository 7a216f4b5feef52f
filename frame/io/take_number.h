#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace becalm::io {

/// Takes a number off the front of `text`, with its sign if there is one.
inline std::optional<int> take_int(std::string_view& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(end - text.data());
  return value;
}

/// Takes the character off the front of `text`, if it is there.
inline bool take(std::string_view& text, char c) {
  if (text.empty() || text.front() != c) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace becalm::io
