#include "tracer/scene/load/wavefront_text.h"

#include "frame/regular_file.h"
#include "frame/text_file.h"
#include "tracer/scene/load/text_words.h"

namespace becalm::tracer {

namespace {

/// A comment may end in a backslash, such as that of a path, and the statement after it must not be lost.
bool is_continued(std::string_view line) {
  return line.ends_with('\\') && line.find('#') == std::string_view::npos;
}

std::string with_joined_lines(std::string_view text) {
  std::string joined;
  joined.reserve(text.size() + 1);
  while (!text.empty()) {
    std::size_t lines = 1;
    std::string_view line = take_line(text);
    for (; is_continued(line); line = take_line(text)) {
      joined.append(line.substr(0, line.size() - 1)) += ' ';
      ++lines;
    }
    joined.append(line).append(lines, '\n');
  }
  return joined;
}

}  // namespace

std::optional<std::string> read_wavefront_text(const std::string& path) {
  refuse_other_than_file(path, "an OBJ or MTL file");
  std::optional<std::string> text = read_text_file(path);
  if (!text) return text;
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (text->starts_with(byte_order_mark)) text->erase(0, byte_order_mark.size());
  const bool may_continue = text->find('\\') != std::string::npos;
  if (may_continue) text = with_joined_lines(*text);
  return text;
}

}  // namespace becalm::tracer
