#include "app/eye_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "frame/error.h"

namespace becalm::app {

std::string name_of_eye(Eye eye) {
  return eye == Eye::centre ? "" : std::string(kEyeNames[eye == Eye::left ? 0 : 1]);
}

bool is_eye(std::string_view view, Eye eye) {
  const std::string_view name = kEyeNames[eye == Eye::left ? 0 : 1];
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  return (view.size() == 1 || view.size() == name.size()) &&
         std::ranges::equal(view, name.substr(0, view.size()), same);
}

bool are_eyes(std::string_view first, std::string_view second) {
  return (is_eye(first, Eye::left) && is_eye(second, Eye::right)) ||
         (is_eye(first, Eye::right) && is_eye(second, Eye::left));
}

bool has_eye_field(std::string_view pattern) {
  return pattern_of_eye(pattern, 0) != pattern;
}

void refuse_eye_field(std::string_view pattern) {
  if (!has_eye_field(pattern)) return;
  throw Error(ExitStatus::usage,
              fmt::format("{}: has a field for the eye, expected the files of one eye, such as {}", pattern,
                          pattern_of_eye(pattern, 0)));
}

std::string pattern_of_eye(std::string_view pattern, std::size_t eye) {
  std::string text;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const char next = pattern[i] == '%' && i + 1 < pattern.size() ? pattern[i + 1] : '\0';
    if (next != 'V' && next != 'v') {
      text += pattern[i];
      continue;
    }
    text += kEyeNames[eye].substr(0, next == 'V' ? std::string_view::npos : 1);
    ++i;
  }
  return text;
}

}  // namespace becalm::app
