#include "frame/io/sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <optional>

#include "frame/error.h"
#include "frame/io/read_error.h"
#include "frame/io/take_number.h"
#include "frame/names_in.h"

namespace becalm::io {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

struct Field {
  std::size_t begin = 0;
  std::size_t end = 0;
  int padding = 1;
  bool probe_disk = false;  ///< a lone `#`
};

std::size_t skip_while(std::string_view text, std::size_t from, auto accept) {
  while (from < text.size() && accept(text[from])) ++from;
  return from;
}

/// `@`, `%d`, `$F` or `#`, which names may have for other reasons.
bool is_lone(std::string_view written) {
  return written == "@" || written == "%d" || written == "$F" || written == "#";
}

/// Whether a field that ends at `end` is none, as in `me@home.exr`, `50%done.exr` and `$FOO.exr`.
bool is_in_a_word(std::string_view text, std::size_t begin, std::size_t end) {
  const std::string_view written = text.substr(begin, end - begin);
  return is_lone(written) && written != "#" && end < text.size() &&
         (is_letter(text[end]) || is_digit(text[end]));
}

/// The frame field that starts at `at`, if one does.
std::optional<Field> field_at(std::string_view text, std::size_t at) {
  const char c = text[at];
  if (c == '#' || c == '@') {
    const std::size_t end = skip_while(text, at, [c](char other) { return other == c; });
    if (is_in_a_word(text, at, end)) return std::nullopt;
    const int length = static_cast<int>(end - at);
    return Field{at, end, length, c == '#' && length == 1};
  }
  const bool printf_style = c == '%';
  if (!printf_style && text.substr(at, 2) != "$F") return std::nullopt;
  const std::size_t digits_begin = at + (printf_style ? 1 : 2);
  const std::size_t digits_end = skip_while(text, digits_begin, is_digit);
  std::string_view digits = text.substr(digits_begin, digits_end - digits_begin);
  if (printf_style && (digits_end == text.size() || text[digits_end] != 'd')) return std::nullopt;
  // `%4d` pads with spaces in printf, which no renderer writes; it stays literal text.
  if (printf_style && !digits.empty() && digits.front() != '0') return std::nullopt;
  int padding = digits.empty() ? 1 : 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), padding);
  const std::size_t end = digits_end + (printf_style ? 1 : 0);
  constexpr int longest_name = 255;
  if (padding < 1 || padding > longest_name || is_in_a_word(text, at, end)) return std::nullopt;
  return Field{at, end, padding, false};
}

/// Whether nothing but a frame field would be written so: `##`, `%04d` and `$F4`, not `100%done` and `$FOO`.
bool is_surely_a_field(std::string_view text, const Field& field) {
  const std::string_view written = text.substr(field.begin, field.end - field.begin);
  if (written.starts_with('%')) return written != "%d";
  if (!written.starts_with('$')) return written.size() > 1;
  return field.end == text.size() || std::isalpha(static_cast<unsigned char>(text[field.end])) == 0;
}

/// The frame field in a path's file name. Folders are taken as they are: a field there would make the frames
/// of one shot lie in many folders. Throws Error(usage) for two fields.
std::optional<Field> field_of_name(std::string_view path) {
  std::vector<Field> fields;
  const std::size_t slash = path.rfind('/');
  for (std::size_t at = slash == std::string_view::npos ? 0 : slash + 1; at < path.size();) {
    const std::optional<Field> found = field_at(path, at);
    if (found) fields.push_back(*found);
    at = found ? found->end : at + 1;
  }
  const auto written = [&](const Field& field) { return path.substr(field.begin, field.end - field.begin); };
  const bool one_is_sure =
      std::ranges::any_of(fields, [&](const Field& field) { return is_surely_a_field(path, field); });
  if (one_is_sure) std::erase_if(fields, [](const Field& field) { return field.probe_disk; });
  if (fields.empty()) return std::nullopt;
  if (fields.size() > 1) {
    throw Error(ExitStatus::usage,
                fmt::format("file pattern '{}': two frame fields, '{}' and '{}'; expected one at most", path,
                            written(fields[0]), written(fields[1])));
  }
  return fields.front();
}

/// `-?digits` and nothing else.
bool is_frame_number(std::string_view text) {
  take(text, '-');
  return !text.empty() && std::all_of(text.begin(), text.end(), is_digit);
}

/// Whether a folder that cannot be listed counts as empty where only its listing is forbidden: files may be
/// written into such a folder all the same.
enum class Unlistable { error, empty };

/// What stands between `prefix` and `suffix` in the names of files that exist, where it is a number; nothing
/// where there is no such folder. Throws Error where the folder cannot be listed to its end.
std::vector<std::string> numbers_on_disk(const std::string& prefix, const std::string& suffix,
                                         Unlistable unlistable) {
  const std::size_t slash = prefix.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : prefix.substr(0, slash + 1);
  const std::string stem = slash == std::string::npos ? prefix : prefix.substr(slash + 1);
  std::vector<std::string> numbers;
  std::error_code error;
  for (const std::string& name : names_in(folder, error)) {
    if (name.size() <= stem.size() + suffix.size() || !name.starts_with(stem) || !name.ends_with(suffix))
      continue;
    std::string middle = name.substr(stem.size(), name.size() - stem.size() - suffix.size());
    if (is_frame_number(middle)) numbers.push_back(std::move(middle));
  }
  const bool is_absent = error == std::errc::no_such_file_or_directory || error == std::errc::not_a_directory;
  const bool is_empty = error == std::errc::permission_denied && unlistable == Unlistable::empty;
  if (error && !is_absent && !is_empty) fail_to_read(folder, error, "folder cannot be listed");
  return numbers;
}

bool is_negative(const std::string& number) {
  return number.front() == '-';
}

bool is_zero_padded(const std::string& number) {
  const std::size_t digits = number.size() - is_negative(number);
  return digits > 1 && number[is_negative(number)] == '0';
}

/// Whether `-0001` is written for a padding of 4, as Blender does, and not `-001`.
bool has_sign_before_padding(const std::vector<std::string>& numbers, int padding) {
  const auto has = [&](int size) {
    return std::ranges::any_of(numbers, [size](const std::string& number) {
      return is_negative(number) && is_zero_padded(number) && std::ssize(number) == size;
    });
  };
  return has(padding + 1) && !has(padding);
}

/// The width that most zero-padded numbers have, of positive ones if there are any. If none is padded, the
/// width of the shortest number, since a wider padding would have added zeros to it.
int padding_of(const std::vector<std::string>& numbers) {
  if (numbers.empty()) return 1;
  std::map<int, int> zero_padded;
  std::size_t least = numbers.front().size();
  const bool positive = std::ranges::any_of(
      numbers, [](const std::string& number) { return !is_negative(number) && is_zero_padded(number); });
  for (const std::string& number : numbers) {
    if (is_zero_padded(number) && !(positive && is_negative(number)))
      ++zero_padded[static_cast<int>(number.size())];
    least = std::min(least, number.size());
  }
  if (zero_padded.empty()) return static_cast<int>(least);
  return std::max_element(zero_padded.begin(), zero_padded.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

/// Where the frame number stands in a path that has one, as frame_in_name finds it; empty without one.
std::string_view number_digits(std::string_view path) {
  const std::string_view name = path.substr(path.rfind('/') + 1);
  const std::string_view stem = name.substr(0, name.rfind('.'));
  std::string_view digits;
  for (std::string_view rest = stem; digits.empty() && !rest.empty();) {
    const std::size_t dot = rest.rfind('.');
    const std::string_view part = dot == std::string_view::npos ? rest : rest.substr(dot + 1);
    if (is_frame_number(part)) digits = part;
    rest = dot == std::string_view::npos ? std::string_view() : rest.substr(0, dot);
  }
  if (digits.empty()) {
    std::size_t begin = stem.size();
    while (begin > 0 && is_digit(stem[begin - 1])) --begin;
    const auto letter_before = [&](char letter) {
      return begin > 0 && (stem[begin - 1] == letter || stem[begin - 1] == letter - 'a' + 'A');
    };
    const bool follows_letter = begin > 1 && is_letter(stem[begin - 2]);
    const bool follows_digit = begin > 1 && is_digit(stem[begin - 2]);
    if ((letter_before('v') && !follows_letter) || (letter_before('x') && follows_digit)) return {};
    digits = stem.substr(begin);
  }
  return digits;
}

}  // namespace

std::optional<NamedFrame> frame_in_name(const std::string& path) {
  const std::string_view digits = number_digits(path);
  std::string_view rest = digits;
  const std::optional<int> number = take_int(rest);
  if (!number || !rest.empty()) return std::nullopt;
  return NamedFrame{*number, static_cast<int>(digits.size())};
}

std::optional<std::string> pattern_of_frame(const std::string& path) {
  const std::string_view digits = number_digits(path);
  if (digits.empty()) return std::nullopt;
  std::string pattern = path;
  std::fill_n(pattern.begin() + (digits.data() - path.data()), digits.size(), '#');
  return pattern;
}

std::vector<std::string> patterns_of_files(std::span<const std::string> paths) {
  std::map<std::string, std::string> patterns;  // by the pattern with a lone '#'
  for (const std::string& path : paths) {
    const std::string pattern = pattern_of_frame(path).value_or(path);
    const std::string_view digits = number_digits(path);
    std::string alone = pattern;
    if (!digits.empty()) alone.replace(digits.data() - path.data(), digits.size(), "#");
    const auto [found, added] = patterns.emplace(alone, pattern);
    if (!added && found->second != pattern) found->second = alone;
  }
  std::vector<std::string> all;
  all.reserve(patterns.size());
  for (const auto& [alone, pattern] : patterns) all.push_back(pattern);
  return all;
}

std::string field_of_folder(const std::string& path) {
  const std::string_view folders = std::string_view(path).substr(0, path.rfind('/') + 1);
  for (std::size_t at = 0; at < folders.size(); ++at) {
    const std::optional<Field> field = field_at(folders, at);
    if (!field || !is_surely_a_field(folders, *field)) continue;
    std::error_code error;
    const std::string_view folder = folders.substr(0, folders.find('/', at));
    if (std::filesystem::exists(folder, error)) return "";
    return std::string(folders.substr(at, field->end - field->begin));
  }
  return "";
}

int number_in_name(const std::string& path) {
  const std::optional<NamedFrame> named = frame_in_name(path);
  return named ? named->number : 1;
}

SequencePattern::SequencePattern(std::string text) : SequencePattern(std::move(text), std::nullopt) {}

SequencePattern::SequencePattern(std::string text, int lone_padding)
    : SequencePattern(std::move(text), std::optional(lone_padding)) {}

SequencePattern::SequencePattern(std::string text, std::optional<int> lone_padding)
    : text_(std::move(text)), prefix_(text_) {
  const std::optional<Field> field = field_of_name(text_);
  if (!field) return;
  const std::string written = text_.substr(field->begin, field->end - field->begin);
  std::error_code unknown;
  if (is_lone(written) && std::filesystem::is_regular_file(text_, unknown)) return;
  if (is_lone(written)) lone_field_ = written;
  prefix_ = text_.substr(0, field->begin);
  suffix_ = text_.substr(field->end);
  const std::vector<std::string> numbers = numbers_on_disk(prefix_, suffix_, Unlistable::empty);
  padding_is_found_ = field->probe_disk && !lone_padding;
  padding_ = padding_is_found_ ? padding_of(numbers) : field->probe_disk ? *lone_padding : field->padding;
  sign_before_padding_ = has_sign_before_padding(numbers, padding_);
}

std::string SequencePattern::number_text(int frame) const {
  const bool outside = sign_before_padding_ && frame < 0;
  return fmt::format("{:0{}}", frame, padding_ + (outside ? 1 : 0));
}

std::string SequencePattern::path(int frame) const {
  if (!has_frame_field()) return text_;
  return prefix_ + number_text(frame) + suffix_;
}

std::vector<int> SequencePattern::frames_on_disk() const {
  std::vector<int> frames;
  if (!has_frame_field()) return frames;
  std::string other_padding;  // of a lone field
  for (std::string_view number : numbers_on_disk(prefix_, suffix_, Unlistable::error)) {
    const std::string_view whole = number;
    const std::optional<int> frame = take_int(number);
    // `shot.12.exr` is no frame of `shot.####.exr`: opening frame 12 would look for another file.
    if (frame && number_text(*frame) == whole)
      frames.push_back(*frame);
    else if (frame && padding_is_found_)
      other_padding = whole;
  }
  if (!other_padding.empty() && !frames.empty()) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: {} and {}{}{} are padded differently; write #### or %d for those that are "
                            "meant",
                            text_, path(frames.front()), prefix_, other_padding, suffix_));
  }
  std::sort(frames.begin(), frames.end());
  return frames;
}

void SequencePattern::refuse_wider_numbers() const {
  if (!has_frame_field()) return;
  std::string wider;
  std::size_t narrowest = std::string::npos;  // of those that the pattern takes
  for (const std::string& number : numbers_on_disk(prefix_, suffix_, Unlistable::error)) {
    std::string_view rest = number;
    const std::optional<int> frame = take_int(rest);
    if (!frame) continue;
    const std::size_t own = number_text(*frame).size();
    if (number.size() > own) wider = number;
    if (number.size() == own) narrowest = std::min(narrowest, own);
  }
  // Where those that it takes are narrower, wider ones are another sequence.
  if (wider.empty() || narrowest == std::string::npos || narrowest < wider.size()) return;
  throw Error(ExitStatus::bad_input,
              fmt::format("{}: {}{}{} would be left out, since its number is padded wider; write {} to take "
                          "both, or name the frames",
                          text_, prefix_, wider, suffix_, std::string(wider.size(), '#')));
}

std::string SequencePattern::hint_where_missing() const {
  if (!has_frame_field()) return "";
  std::vector<std::string> numbers = numbers_on_disk(prefix_, suffix_, Unlistable::error);
  if (numbers.empty() && !lone_field_.empty())
    return fmt::format("; '{}' stands for the frame number", lone_field_);
  const std::size_t matching = std::erase_if(numbers, [&](const std::string& number) {
    std::string_view rest = number;
    const std::optional<int> frame = take_int(rest);
    return !frame || number_text(*frame) == number;
  });
  if (numbers.empty()) return "";
  const std::string other = prefix_ + *std::min_element(numbers.begin(), numbers.end()) + suffix_;
  if (matching > 0) return fmt::format("; {} has another padding", other);
  return fmt::format("; {} is there, and {}#{} finds it", other, prefix_, suffix_);
}

}  // namespace becalm::io
