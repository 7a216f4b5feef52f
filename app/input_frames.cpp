#include "app/input_frames.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <limits>
#include <span>
#include <system_error>

#include "app/cancel.h"
#include "app/eye_names.h"
#include "app/folder_input.h"
#include "app/half_buffers.h"
#include "frame/error.h"
#include "frame/io/exr.h"
#include "frame/io/frame_range.h"

namespace becalm::app {
namespace fs = std::filesystem;

Missing parse_missing(const std::string& name) {
  return name == "skip" ? Missing::skip : name == "hold" ? Missing::hold : Missing::error;
}

int usual_step(const std::vector<int>& frames) {
  std::int64_t step = std::numeric_limits<int>::max();
  for (std::size_t i = 1; i < frames.size(); ++i)
    step = std::min(step, std::int64_t{frames[i]} - frames[i - 1]);
  return frames.size() < 2 ? 1 : static_cast<int>(step);
}

namespace {

/// `frame 9`, `frames 9-11`.
std::string frames_text(const std::vector<int>& frames) {
  return fmt::format("{} {}", frames.size() == 1 ? "frame" : "frames", io::format_frame_range(frames));
}

/// Frames that have a file of some pattern, and those that have one of each.
struct FramesOnDisk {
  std::vector<int> any;
  std::vector<int> complete;
};

FramesOnDisk frames_on_disk(const std::vector<const io::SequencePattern*>& sequences) {
  FramesOnDisk frames{.any = sequences.front()->frames_on_disk(), .complete = {}};
  frames.complete = frames.any;
  for (const io::SequencePattern* pattern : std::span(sequences).subspan(1)) {
    const std::vector<int> others = pattern->frames_on_disk();
    FramesOnDisk both;
    std::ranges::set_union(frames.any, others, std::back_inserter(both.any));
    std::ranges::set_intersection(frames.complete, others, std::back_inserter(both.complete));
    frames = std::move(both);
  }
  return frames;
}

/// The frames with those between them, in their usual step. Throws Error(bad_input) if they are too many.
std::vector<int> every_step(const std::vector<int>& frames, const std::string& pattern) {
  const std::int64_t step = usual_step(frames);
  std::vector<int> all{frames.front()};
  for (const int frame : std::span(frames).subspan(1)) {
    const std::int64_t before = all.back();
    const auto held = static_cast<std::size_t>((frame - before - 1) / step);
    if (all.size() + held >= io::kMaxFrames) {
      throw Error(
          ExitStatus::bad_input,
          fmt::format("{}: between frames {} and {} are {} that would be held, expected fewer than {} "
                      "frames in all; --frames names those wanted",
                      pattern, before, frame, held, io::kMaxFrames));
    }
    for (std::int64_t between = before + step; between < frame; between += step)
      all.push_back(static_cast<int>(between));
    all.push_back(frame);
  }
  return all;
}

}  // namespace

InputFrames::InputFrames(const std::vector<std::string>& patterns, Pair pair, const std::string& range,
                         std::optional<int> frame, Missing missing, const Readable& readable)
    : pattern_(patterns.front()), padding_(pattern_.padding()) {
  const std::string& pattern = pattern_.text();
  for (const std::string& text : patterns) {
    refuse_eye_field(text);
    refuse_folder(text);
  }
  if (patterns.size() > 1) {
    take_other(patterns[1], pair);
  } else if (pair != Pair::none) {
    other_half_ = find_other_half(pattern_);
  }
  if (!pattern_.has_frame_field()) {
    take_single_file(range, frame);
    return;
  }
  if (frame) {
    throw Error(ExitStatus::usage,
                fmt::format("--frame {}: is the number of a single file, and {} is a sequence; --frames says "
                            "which of its frames to write",
                            *frame, pattern));
  }
  std::vector<int> asked;
  if (!range.empty()) asked = io::parse_frame_range(range);
  if (missing == Missing::error) refuse_incomplete(asked);
  const FramesOnDisk on_disk = frames_on_disk(sequences());
  if (on_disk.any.empty()) {
    throw Error(ExitStatus::bad_input, fmt::format("{}: no frame of this sequence is on disk{}", pattern,
                                                   pattern_.hint_where_missing()));
  }
  const bool all = asked.empty();
  if (all) {
    for (const io::SequencePattern* sequence : sequences()) sequence->refuse_wider_numbers();
  }
  if (all) asked = missing == Missing::hold ? every_step(on_disk.any, pattern) : on_disk.any;
  // Frames that are left below make gaps, and no larger steps.
  assign_outputs(asked, on_disk.any, missing);
  step_ = usual_step(readable(sources(), on_disk.any));
  std::vector<int> present = on_disk.complete;
  // A frame that is held is read whether or not it was asked for itself. Without damaged frames others may
  // be.
  do {
    outputs_.clear();
    assign_outputs(asked, present, missing);
    readable_ = readable(sources(), present);
  } while (missing != Missing::error && leave_damaged(present));
  const bool gaps = missing != Missing::hold && std::ranges::adjacent_find(readable_, [&](int a, int b) {
                                                  return b - a > step_;
                                                }) != readable_.end();
  if (all && gaps) {
    notes_.push_back(fmt::format("{}: only frames {} are on disk{}; the filter starts anew after each gap",
                                 pattern, io::format_frame_range(present),
                                 notes_.empty() ? "" : " and whole"));
  }
  note_absent(asked, on_disk.complete, missing);
}

/// The second pattern: the other half of the samples, or the other eye.
void InputFrames::take_other(const std::string& other_pattern, Pair pair) {
  const std::string& pattern = pattern_.text();
  if (pair == Pair::none) {
    throw Error(ExitStatus::usage,
                fmt::format("--no-halves: expected one input, found {} and {}", pattern, other_pattern));
  }
  std::optional<io::SequencePattern>& other = pair == Pair::eyes ? other_eye_ : other_half_;
  other.emplace(other_pattern);
  refuse_no_pair(pattern, other->text(), pair);
  if (other->has_frame_field() != pattern_.has_frame_field()) {
    throw Error(ExitStatus::usage, fmt::format("{}: {} of one sequence must both have a frame field",
                                               other->text(), pair == Pair::eyes ? "eyes" : "halves"));
  }
  if (pair == Pair::eyes && find_other_half(pattern_)) {
    throw Error(ExitStatus::usage,
                fmt::format("{}: holds a half of the samples, expected eyes of all samples", pattern));
  }
}

void InputFrames::note_absent(const std::vector<int>& asked, const std::vector<int>& complete,
                              Missing missing) {
  std::vector<int> absent;
  std::ranges::set_difference(asked, complete, std::back_inserter(absent));
  if (absent.empty()) return;
  const bool is_one = absent.size() == 1;
  const char* what_becomes = missing == Missing::hold
                                 ? (is_one ? "holds the one before it" : "hold those before them")
                                 : (is_one ? "is left out" : "are left out");
  notes_.push_back(fmt::format("{}: {} {} not on disk{} and {}", names(), frames_text(absent),
                               is_one ? "is" : "are", other() ? " in both" : "", what_becomes));
}

/// Takes damaged frames, or such as a renderer still writes, out of those that are present: they count as
/// missing. False if none of those to read is.
bool InputFrames::leave_damaged(std::vector<int>& present) {
  const std::size_t before = present.size();
  for (const io::SequencePattern* pattern : sequences()) {
    std::vector<char> is_damaged(readable_.size(), 0);
    tbb::parallel_for(std::size_t{0}, readable_.size(), [&](std::size_t i) {
      stop_if_asked();
      is_damaged[i] = io::has_all_chunks(pattern->path(readable_[i])) ? 0 : 1;
    });
    std::vector<int> damaged;
    for (std::size_t i = 0; i < readable_.size(); ++i) {
      if (is_damaged[i] != 0) damaged.push_back(readable_[i]);
    }
    if (damaged.empty()) continue;
    const bool is_one = damaged.size() == 1;
    notes_.push_back(fmt::format("{}: {} {} damaged or not whole yet, and {} as missing", pattern->text(),
                                 frames_text(damaged), is_one ? "is" : "are", is_one ? "counts" : "count"));
    std::erase_if(present, [&](int frame) { return std::ranges::binary_search(damaged, frame); });
  }
  return present.size() < before;
}

/// Halves that are one file would show no noise at all, and two frames of a sequence are not one.
void InputFrames::refuse_no_pair(const std::string& first, const std::string& second, Pair pair) {
  const char* what = pair == Pair::eyes ? "eyes" : "halves of one frame";
  std::error_code error;
  if (first == second || fs::equivalent(first, second, error)) {
    throw Error(ExitStatus::usage, fmt::format("{}: is given twice, expected two {}", first, what));
  }
  const std::optional<io::NamedFrame> a = io::frame_in_name(first);
  const std::optional<io::NamedFrame> b = io::frame_in_name(second);
  constexpr int least_padding = 3;  // fewer digits may number the halves
  if (!a || !b || a->number == b->number || std::min(a->padding, b->padding) < least_padding) return;
  throw Error(ExitStatus::usage,
              fmt::format("{} and {}: are frames {} and {}, expected two {}; a sequence is one argument in "
                          "quotes: '{}'",
                          first, second, a->number, b->number, what, *io::pattern_of_frame(first)));
}

void InputFrames::refuse_incomplete(const std::vector<int>& asked) const {
  if (!other()) return;
  const std::vector<int> first = pattern_.frames_on_disk();
  const std::vector<int> second = other()->frames_on_disk();
  const auto refuse = [&](const std::vector<int>& there, const std::vector<int>& here,
                          const io::SequencePattern& has, const io::SequencePattern& lacks) {
    std::vector<int> alone;
    std::ranges::set_difference(there, here, std::back_inserter(alone));
    if (!asked.empty())
      std::erase_if(alone, [&](int frame) { return !std::ranges::binary_search(asked, frame); });
    if (alone.empty()) return;
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: no file for {} {}, which {} has{}; --missing skip or hold goes on without",
                            lacks.text(), alone.size() == 1 ? "frame" : "frames",
                            io::format_frame_range(alone), has.text(), lacks.hint_where_missing()));
  };
  refuse(first, second, pattern_, *other());
  refuse(second, first, *other(), pattern_);
}

void InputFrames::take_single_file(const std::string& range, std::optional<int> frame) {
  const std::string& file = pattern_.text();
  const std::optional<io::NamedFrame> named = io::frame_in_name(file);
  if (!range.empty()) {
    const std::vector<int> asked = io::parse_frame_range(range);
    if (asked.size() > 1) {
      throw Error(
          ExitStatus::usage,
          fmt::format("--frames {}: {} is a single file; a sequence has a frame field, such as ####.exr",
                      range, file));
    }
    const int number = asked.front();
    if (!frame && named && named->number != number) {
      throw Error(ExitStatus::usage,
                  fmt::format("--frames {}: {} is frame {}; --frame {} gives it another number", range, file,
                              named->number, number));
    }
    if (!frame) frame = number;
  }
  if (named) padding_ = named->padding;
  has_numbers_ = frame || named;
  const int number = frame ? *frame : named ? named->number : 1;
  readable_ = {number};
  outputs_[number] = {number};
}

void InputFrames::assign_outputs(const std::vector<int>& asked, const std::vector<int>& present,
                                 Missing missing) {
  std::vector<int> absent;
  std::vector<int> without_earlier;
  for (const int number : asked) {
    const auto after = std::ranges::upper_bound(present, number);
    const bool has_earlier = after != present.begin();
    if (has_earlier && after[-1] == number) {
      outputs_[number].push_back(number);
      continue;
    }
    absent.push_back(number);
    if (!has_earlier) without_earlier.push_back(number);
    if (missing == Missing::hold && has_earlier) outputs_[after[-1]].push_back(number);
  }
  const std::string pattern = names();
  if (!absent.empty() && missing == Missing::error) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: no file for {} {} of {}{}; --missing skip or hold goes on without", pattern,
                            absent.size() == 1 ? "frame" : "frames", io::format_frame_range(absent),
                            io::format_frame_range(asked), pattern_.hint_where_missing()));
  }
  if (missing == Missing::hold && !without_earlier.empty()) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: no {}file for frame {}, and --missing hold has no earlier frame to hold",
                            pattern, notes_.empty() ? "" : "whole ", without_earlier.front()));
  }
  if (outputs_.empty()) {
    throw Error(ExitStatus::bad_input,
                fmt::format("{}: none of frames {} is on disk{}", pattern, io::format_frame_range(asked),
                            notes_.empty() ? "" : " and whole"));
  }
}

std::vector<const io::SequencePattern*> InputFrames::sequences() const {
  std::vector<const io::SequencePattern*> sequences{&pattern_};
  if (other()) sequences.push_back(&*other());
  return sequences;
}

std::string InputFrames::names() const {
  return other() ? fmt::format("{} and {}", pattern_.text(), other()->text()) : pattern_.text();
}

std::vector<std::string> InputFrames::paths(int frame) const {
  std::vector<std::string> paths;
  for (const io::SequencePattern* pattern : sequences()) paths.push_back(pattern->path(frame));
  return paths;
}

io::SequencePattern InputFrames::output_pattern(const std::string& text) const {
  io::SequencePattern output = padding_ > 0 ? io::SequencePattern(text, padding_) : io::SequencePattern(text);
  output.place_sign_as(pattern_);
  return output;
}

std::vector<int> InputFrames::outputs() const {
  std::vector<int> numbers;
  for (const auto& [frame, outputs] : outputs_) numbers.insert(numbers.end(), outputs.begin(), outputs.end());
  return numbers;
}

std::vector<int> InputFrames::sources() const {
  std::vector<int> numbers;
  for (const auto& [frame, outputs] : outputs_) numbers.push_back(frame);
  return numbers;
}

std::set<int> InputFrames::sources_of_missing(const std::set<int>& existing) const {
  std::set<int> frames;
  for (const auto& [frame, outputs] : outputs_) {
    if (!std::ranges::includes(existing, outputs)) frames.insert(frame);
  }
  return frames;
}

std::set<int> InputFrames::up_to_last_missing(const std::set<int>& existing) const {
  const std::set<int> missing = sources_of_missing(existing);
  std::set<int> frames;
  for (const auto& [frame, outputs] : outputs_) {
    if (!missing.empty() && frame <= *missing.rbegin()) frames.insert(frame);
  }
  return frames;
}

}  // namespace becalm::app
