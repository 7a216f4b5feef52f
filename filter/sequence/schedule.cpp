#include "filter/sequence/schedule.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace becalm::filter {
namespace {

/// Frame numbers from `first` to `last`.
struct FrameSpan {
  long first = std::numeric_limits<long>::min();
  long last = std::numeric_limits<long>::max();

  bool contains(int frame) const { return frame >= first && frame <= last; }
};

long floor_divide(long number, long divisor) {
  return number / divisor - (number % divisor < 0 ? 1 : 0);
}

/// The segment that contains a frame.
FrameSpan segment_of(int frame, const ScheduleOptions& options) {
  if (options.segment == 0) return {};
  const long first = floor_divide(frame, options.segment) * options.segment;
  return {first, first + options.segment - 1};
}

bool starts_anew(int frame, int before, const ScheduleOptions& options) {
  if (std::abs(static_cast<long>(frame) - before) > options.step) return true;
  const auto cut = options.cuts.upper_bound(std::min(frame, before));
  return cut != options.cuts.end() && *cut <= std::max(frame, before);
}

/// Appends one pass over `frames`, which are in the order of the direction: of each shot, the frames up to
/// its last wanted one.
void append_pass(Direction direction, const std::vector<int>& frames, const std::set<int>& wanted,
                 const ScheduleOptions& options, Segment& segment) {
  Segment pass;
  std::size_t end = 0;
  for (const int frame : frames) {
    const bool anew = pass.empty() || starts_anew(frame, pass.back().frame, options);
    if (anew) pass.resize(end);  // frames of a shot after its last wanted one
    pass.push_back(
        {.frame = frame, .direction = direction, .new_history = anew, .wanted = wanted.contains(frame)});
    if (pass.back().wanted) end = pass.size();
  }
  segment.insert(segment.end(), pass.begin(), pass.begin() + static_cast<std::ptrdiff_t>(end));
}

}  // namespace

std::vector<Segment> schedule(std::span<const int> present, const std::set<int>& wanted,
                              const ScheduleOptions& options) {
  std::vector<Segment> segments;
  for (auto next = wanted.begin(); next != wanted.end();) {
    const FrameSpan span = segment_of(*next, options);
    std::set<int> of_segment;
    for (; next != wanted.end() && span.contains(*next); ++next) of_segment.insert(*next);
    FrameSpan read = span;
    if (options.segment != 0) read = {span.first - options.warmup, span.last + options.warmup};
    const auto first = std::ranges::lower_bound(present, read.first);
    const std::vector<int> frames(first, std::ranges::upper_bound(first, present.end(), read.last));

    Segment& segment = segments.emplace_back();
    if (options.directions == Directions::both) {
      append_pass(Direction::backward, {frames.rbegin(), frames.rend()}, of_segment, options, segment);
    }
    append_pass(Direction::forward, frames, of_segment, options, segment);
  }
  std::set<int> later;
  for (auto segment = segments.rbegin(); segment != segments.rend(); ++segment) {
    for (auto step = segment->rbegin(); step != segment->rend(); ++step) {
      step->again = !later.insert(step->frame).second;
    }
  }
  return segments;
}

}  // namespace becalm::filter
