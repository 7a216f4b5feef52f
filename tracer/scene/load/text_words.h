#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

namespace becalm::tracer {

// Words of text files with one statement a line (OBJ, MTL). Lines end with "\n", "\r\n" or "\r".

inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

/// The next line of the text, removed from it.
inline std::string_view take_line(std::string_view& text) {
  const auto ends_line = [](char c) { return c == '\n' || c == '\r'; };
  const auto end = static_cast<std::size_t>(std::ranges::find_if(text, ends_line) - text.begin());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end);
  text.remove_prefix(text.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, text.size()));
  return line;
}

/// The next word of the line, removed from it; empty at its end.
inline std::string_view take_word(std::string_view& line) {
  const auto begin = std::ranges::find_if_not(line, is_blank);
  const auto end = std::find_if(begin, line.end(), is_blank);
  const std::string_view word(begin, end);
  line = std::string_view(end, line.end());
  return word;
}

/// What is left of the line, without blanks around it.
inline std::string_view trimmed(std::string_view line) {
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  while (!line.empty() && is_blank(line.back())) line.remove_suffix(1);
  return line;
}

/// What stands before a comment. For lines of numbers: a name may hold any character.
inline std::string_view without_comment(std::string_view line) {
  return line.substr(0, line.find('#'));
}

/// The word as a number; nothing if it is none, or beyond what float can hold. Denormals are numbers.
inline std::optional<float> parse_float(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || stop != word.data() + word.size() ||
      !(std::abs(value) <= std::numeric_limits<float>::max()))
    return std::nullopt;
  return static_cast<float>(value);
}

}  // namespace becalm::tracer
