#pragma once

#include <set>
#include <span>
#include <vector>

#include "filter/settings.h"

namespace becalm::filter {

enum class Direction { forward, backward };

/// One frame that the filter processes in one direction.
struct Step {
  int frame = 0;
  Direction direction = Direction::forward;
  bool new_history = false;  ///< the history of the previous step is dropped
  bool wanted = true;        ///< forward: the frame is output; backward: its prediction is kept until then
  bool again = false;        ///< a later step has the same frame: its smoothed image is kept until then
};

struct ScheduleOptions {
  Directions directions = Directions::both;
  int segment = 0;       ///< frame numbers in a segment; 0: one segment for all frames
  int warmup = 0;        ///< frame numbers on either side of a segment that are filtered with it
  int step = 1;          ///< largest distance of frame numbers across which history is kept
  std::set<int> cuts{};  ///< first frames of new shots
};

/// The steps of one segment: the backward pass first, so that the forward pass finds every prediction.
using Segment = std::vector<Step>;

/// The steps that output every frame of `wanted` once. `present` are the frames that may be read, in
/// ascending order. With B = `segment` and W = `warmup`, segment k has the frame numbers [kB, (k+1)B) and is
/// filtered from the frames in [kB-W, (k+1)B+W) only, so a frame's output does not depend on which other
/// frames are wanted. Segments without wanted frames are omitted, and so are steps that no wanted frame
/// depends on.
std::vector<Segment> schedule(std::span<const int> present, const std::set<int>& wanted,
                              const ScheduleOptions& options);

}  // namespace becalm::filter
