#pragma once

#include <set>
#include <span>
#include <vector>

#include "filter/settings.h"

namespace becalm::filter {

enum class Direction { forward, backward };

/// One frame on its way through the filter.
struct Step {
  int frame = 0;
  Direction direction = Direction::forward;
  bool new_history = false;  ///< nothing is carried over from the step before
  bool wanted = true;        ///< forward: the frame comes out; backward: its prediction is kept until then
  bool again = false;        ///< a later step is of the same frame: its smoothed image is kept until then
};

struct ScheduleOptions {
  Directions directions = Directions::both;
  int segment = 0;       ///< frame numbers in a segment; 0: all frames are one
  int warmup = 0;        ///< frame numbers before and after a segment that are filtered with it
  int step = 1;          ///< frames whose numbers are further apart have others missing between them
  std::set<int> cuts{};  ///< first frames of new shots
};

/// The steps of one segment: backward in time first, so that the forward pass finds every prediction made.
using Segment = std::vector<Step>;

/// In which order frames meet so that every one of `wanted` comes out once; `present` are those that may be
/// read, ascending. Segment k is the frame numbers [kB, (k+1)B), whatever is wanted and present, and is
/// filtered from those in [kB-W, (k+1)B+W) alone: what comes out for a frame does not depend on what else is
/// wanted. Segments of which nothing is wanted are left out, and so are steps that nothing wanted depends on.
std::vector<Segment> schedule(std::span<const int> present, const std::set<int>& wanted,
                              const ScheduleOptions& options);

}  // namespace becalm::filter
