#include "frame/io/frame_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "frame/error.h"
#include "frame/io/take_number.h"

namespace becalm::io {
namespace {

class RangeParser {
 public:
  RangeParser(std::string_view text, std::string_view what) : text_(text), what_(what) {}

  std::vector<int> parse() {
    std::string_view rest = text_;
    do {
      take_item(rest);
    } while (take(rest, ','));
    if (!rest.empty()) fail(fmt::format("'{}' was not expected", rest));
    std::sort(frames_.begin(), frames_.end());
    frames_.erase(std::unique(frames_.begin(), frames_.end()), frames_.end());
    return std::move(frames_);
  }

  /// Of the text that was parsed.
  int step() const {
    const Range& one = ranges_.front();
    const bool is_even = std::ranges::all_of(ranges_, [&one](const Range& range) {
      return range.step == one.step && (range.first - one.first) % one.step == 0;
    });
    return is_even ? one.step : 1;
  }

 private:
  struct Range {
    std::int64_t first;
    int step;
  };

  [[noreturn]] void fail(const std::string& why) const {
    throw Error(
        ExitStatus::usage,
        fmt::format("{} '{}': {}; expected such as 1-100, 1-100x2, 5 or 1-10,20-30", what_, text_, why));
  }

  int take_number(std::string_view& rest, std::string_view what) const {
    const std::optional<int> number = take_int(rest);
    if (!number) fail(fmt::format("no {} at {}", what, rest.empty() ? "its end" : fmt::format("'{}'", rest)));
    return *number;
  }

  void take_item(std::string_view& rest) {
    const std::int64_t first = take_number(rest, "frame number");
    std::int64_t last = first;
    int step = 1;
    if (take(rest, '-')) {
      last = take_number(rest, "last frame number");
      if (last < first) fail(fmt::format("the range descends from {} to {}", first, last));
      if (take(rest, 'x')) {
        step = take_number(rest, "step");
        if (step < 1) fail(fmt::format("the step {} is below 1", step));
      }
    }
    ranges_.push_back({first, step});
    if ((last - first) / step + 1 + static_cast<std::int64_t>(frames_.size()) > kMaxFrames) {
      fail(fmt::format("more than {} frames", kMaxFrames));
    }
    for (std::int64_t frame = first; frame <= last; frame += step) frames_.push_back(static_cast<int>(frame));
  }

  std::string_view text_;
  std::string_view what_;
  std::vector<int> frames_;
  std::vector<Range> ranges_;
};

}  // namespace

std::vector<int> parse_frame_range(std::string_view text, std::string_view what) {
  return RangeParser(text, what).parse();
}

int frame_range_step(std::string_view text, std::string_view what) {
  RangeParser parser(text, what);
  parser.parse();
  return parser.step();
}

std::string format_frame_range(const std::vector<int>& frames) {
  std::string text;
  for (std::size_t begin = 0; begin < frames.size();) {
    std::size_t end = begin + 1;
    const std::int64_t step =
        end < frames.size() ? static_cast<std::int64_t>(frames[end]) - frames[begin] : std::int64_t{0};
    while (end < frames.size() && static_cast<std::int64_t>(frames[end]) - frames[end - 1] == step) ++end;
    if (!text.empty()) text += ',';
    if (end - begin < 3) {
      end = begin + 1;
      text += fmt::format("{}", frames[begin]);
    } else {
      text += fmt::format("{}-{}", frames[begin], frames[end - 1]);
      if (step != 1) text += fmt::format("x{}", step);
    }
    begin = end;
  }
  return text;
}

std::string format_frame_range(const std::vector<int>& frames, int step) {
  if (frames.empty()) return "";
  const bool is_even = std::ranges::all_of(
      frames, [&](int frame) { return (std::int64_t{frame} - frames.front()) % step == 0; });
  if (step == 1 || !is_even) {
    std::string text = format_frame_range(frames);
    if (frame_range_step(text) == 1) return text;
    return fmt::format("{},{}", frames.front(), format_frame_range({frames.begin() + 1, frames.end()}));
  }
  std::string text;
  for (auto begin = frames.begin(); begin != frames.end();) {
    auto last = begin;
    while (last + 1 != frames.end() && std::int64_t{last[1]} - *last == step) ++last;
    text += fmt::format("{}{}-{}x{}", text.empty() ? "" : ",", *begin, *last, step);
    begin = last + 1;
  }
  return text;
}

}  // namespace becalm::io
