#include "app/input_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>

#include "frame/error.h"

namespace becalm::app {
namespace {

/// A sequence on ones, twos, ...: the smallest distance between its frames.
int usual_step(const std::vector<int>& frames) {
  int step = std::numeric_limits<int>::max();
  for (std::size_t i = 1; i < frames.size(); ++i) step = std::min(step, frames[i] - frames[i - 1]);
  return step;
}

}  // namespace

Missing parse_missing(const std::string& name) {
  return name == "skip" ? Missing::skip : name == "hold" ? Missing::hold : Missing::error;
}

InputFrames::InputFrames(const std::string& pattern, const std::string& range, Missing missing)
    : pattern_(pattern) {
  std::vector<int> asked;
  if (!range.empty()) asked = io::parse_frame_range(range);
  if (!pattern_.has_frame_field()) {
    if (asked.size() > 1) {
      throw Error(ExitStatus::usage,
                  fmt::format("--frames {}: {} is a single file; a sequence has a frame field, such "
                              "as ####.exr",
                              range, pattern));
    }
    frames_.push_back({asked.empty() ? 1 : asked.front(), true, {}});
    frames_.front().outputs = {frames_.front().number};
    return;
  }
  const std::vector<int> present = pattern_.frames_on_disk();
  if (present.empty()) {
    throw Error(ExitStatus::bad_input, fmt::format("{}: no frame of this sequence is on disk", pattern));
  }
  take(asked.empty() ? present : asked, present, missing);
  if (asked.empty() &&
      std::any_of(frames_.begin() + 1, frames_.end(), [](auto& frame) { return frame.new_history; })) {
    note_ = fmt::format("{}: only frames {} are on disk; the filter starts anew after each gap", pattern,
                        io::format_frame_range(present));
  }
}

void InputFrames::take(const std::vector<int>& asked, const std::vector<int>& present, Missing missing) {
  const int step = usual_step(asked);
  std::vector<int> absent;
  bool has_previous = false;
  int previous = 0;
  for (const int number : asked) {
    if (std::binary_search(present.begin(), present.end(), number)) {
      frames_.push_back({number, !has_previous || number - previous > step, {number}});
      previous = number;
      has_previous = true;
      continue;
    }
    absent.push_back(number);
    if (missing == Missing::hold && has_previous) frames_.back().outputs.push_back(number);
  }
  const std::string& pattern = pattern_.text();
  if (!absent.empty() && missing == Missing::error) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: no file for frame {} of {}; --missing skip or hold goes on without", pattern,
                            io::format_frame_range(absent), io::format_frame_range(asked)));
  }
  if (frames_.empty()) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: none of frames {} is on disk", pattern, io::format_frame_range(asked)));
  }
  if (missing == Missing::hold && !absent.empty() && absent.front() < frames_.front().number) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: no file for frame {}, and --missing hold has no earlier frame "
                            "to hold",
                            pattern, absent.front()));
  }
}

std::vector<int> InputFrames::outputs() const {
  std::vector<int> numbers;
  for (const InputFrame& frame : frames_)
    numbers.insert(numbers.end(), frame.outputs.begin(), frame.outputs.end());
  return numbers;
}

std::vector<InputFrame> InputFrames::up_to_last_missing(const std::set<int>& existing) const {
  const auto last = std::find_if(frames_.rbegin(), frames_.rend(), [&](const InputFrame& frame) {
    return std::any_of(frame.outputs.begin(), frame.outputs.end(),
                       [&](int number) { return !existing.contains(number); });
  });
  return {frames_.begin(), last.base()};
}

}  // namespace becalm::app
