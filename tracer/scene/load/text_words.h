#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

namespace becalm::tracer {

// Words of text files with one statement a line (OBJ, MTL).

inline constexpr std::string_view kBlanks = " \t\r";

/// The next line of the text, removed from it.
inline std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/// The next word of the line, removed from it; empty at its end.
inline std::string_view take_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(word.size());
  return word;
}

/// What is left of the line, without blanks around it.
inline std::string_view trimmed(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  return line.substr(0, line.find_last_not_of(kBlanks) + 1);
}

/// Whether the word is a number that float can hold; denormals count as such.
inline bool is_float(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && stop == word.data() + word.size() &&
         std::abs(value) <= std::numeric_limits<float>::max();
}

}  // namespace becalm::tracer
